// Functions of a page under test: the next control to use, and the effects of the last one.
(() => {
  const SELECTOR = 'button, input, select, textarea, a[href], summary, [role=option], [role=slider]'
  const LAST = /\b(close|dismiss|cancel|remove|delete|clear|erase|disconnect|disarm|land|return|terminate|reboot|end|leave|restart|stop|new plan|insert|finish)\b/i
  // What removes the list that it is in, before what closes it.
  const LATE = /^Replay/
  // On a phone a list is hidden by what was chosen from it.
  const BACK = /^All messages$/
  const MAX_ATTEMPTS = 2
  const LONG_LIST = 12
  const MAX_ROUNDS = 6
  const MAX_SETTLING = 2000
  const FRAME = 150
  // The rank of what may hide other controls.
  const OPENER = 6
  // Parts of a map on which an area is drawn.
  const CORNERS = [[0.35, 0.4], [0.65, 0.4], [0.65, 0.6], [0.35, 0.6]]
  const text = each => (each?.textContent ?? '').trim().replace(/\s+/g, ' ')
  const nameOf = each => {
    const ids = each.getAttribute('aria-labelledby')
    const labels = each.labels ? [...each.labels].map(text).join(' ') : ''
    const name = each.getAttribute('aria-label') || (ids && ids.split(' ').map(id => text(document.getElementById(id))).join(' ')) ||
      labels || (each.matches('input, select, textarea') ? '' : text(each)) || each.title || each.placeholder || ''
    return name.trim()
  }
  // Controls that differ in a number, in what is chosen, or in the name of a parameter or a message, count as one.
  const ALIKE = [[/^(Copter|Plane|Drone) #.*/, 'a vehicle'], [/^Check list .*/, 'Check list'], [/^Plot .*/, 'Plot a field'], [/^#\/# .*/, 'a source'], [/ \(#\)$/, ''], [/^# .* #.*/, 'entry of a list'], [/^(?!Nothing).* .*\.$/, 'a finding'], [/^(Functions of [^:]*): .*/, '$1']]
  const general = name => ALIKE.reduce((short, [pattern, word]) => short.replace(pattern, word), name.replace(/\b[A-Z][A-Z0-9]*_[A-Z0-9_]+\b/g, 'NAME').replace(/[-+\u2212]?\d+(?:[.,:\u2009]\d+)*/g, '#')).slice(0, 90)
  const kindOf = each => each.getAttribute('role') || (each.localName === 'input' ? each.type : each.localName)
  // The entries of a long list are alike.
  const isEntry = each => each.matches('[role=option]') ||
    (each.matches('li *, tr *') && each.closest('li, tr').parentElement.childElementCount > LONG_LIST)
  const keyOf = each => `${kindOf(each)}: ${isEntry(each) ? 'entry of a list' : general(nameOf(each))}`
  const isShown = each => each.checkVisibility({ visibilityProperty: true, opacityProperty: true }) &&
    (each.getBoundingClientRect().width > 0 || each.closest('label'))
  const isEnabled = each => !each.matches(':disabled') && each.getAttribute('aria-disabled') !== 'true'
  const isOpener = each => each.matches('[role=tab], [aria-expanded], nav *, summary') || BACK.test(nameOf(each))
  const isOpen = each => each.getAttribute('aria-expanded') === 'true' || (each.localName === 'summary' && each.parentElement.open)
  // A click on what is already chosen changes nothing.
  const isChosen = each => each.getAttribute('href') === location.hash || each.matches('[aria-selected=true], [aria-pressed=true], [aria-current], :checked')
  // A choice may remove other fields. A control that is used again comes after the new ones of its kind.
  const isLast = each => each.matches('button, a') && LAST.test(nameOf(each))
  const rank = each => (isLast(each) ? OPENER + 2 : isOpener(each) ? OPENER : each.matches('button, a') ? (LATE.test(nameOf(each)) ? 5 : 4) : each.matches('select') ? 2 : 0) + (again.has(keyOf(each)) ? 1 : 0)

  const seen = new Set(), enabled = new Set(), used = new Set(), nameless = new Set(), reopened = new Set()
  const attempts = new Map(), problems = new Map(), openedBy = new Map(), removedBy = new Map(), again = new Set(), starters = new Set(), drawnFor = new Set()
  let round = 0, usedBefore = -1, isStuck = false, last = null, tool = null
  let excluded = /(?!)/, root = 'main', current = null, isArmed = false, effects = 0, requests = 0, shown = new Set()

  const effect = () => { if (isArmed) effects += 1 }
  const watch = (owner, name) => {
    const original = owner?.[name]
    if (typeof original !== 'function') return
    owner[name] = function (...values) { effect(); return original.apply(this, values) }
  }
  // The crawler's own waits are no effects.
  const { setTimeout: later, clearTimeout: cancel, requestAnimationFrame: draw } = window
  for (const [owner, names] of [
    [window, ['fetch', 'open', 'setTimeout']], [WebSocket.prototype, ['send']],
    [XMLHttpRequest.prototype, ['send']], [Worker.prototype, ['postMessage']], [Storage.prototype, ['setItem', 'removeItem']],
    [URL, ['createObjectURL']], [HTMLElement.prototype, ['click', 'focus', 'scrollIntoView']],
    [Element.prototype, ['requestFullscreen']], [navigator.clipboard, ['writeText']], [navigator.serial, ['requestPort']],
  ]) for (const name of names) watch(owner, name)
  // Controls that a request brings belong to the action that made it.
  const watched = window.fetch
  window.fetch = function (...values) {
    requests += 1
    return watched.apply(this, values).finally(() => { requests -= 1 })
  }
  // Long calls follow their task by events; flights are followed for longer than an action waits.
  const { EventSource: Followed } = window
  window.EventSource = class extends Followed {
    constructor (...values) {
      super(...values)
      requests += 1
      this.timer = later(() => this.count(), MAX_SETTLING)
    }
    count () {
      if (this.timer !== null) requests -= 1
      cancel(this.timer)
      this.timer = null
    }
    close () {
      super.close()
      later(() => this.count(), FRAME)
    }
  }
  // Instruments that are drawn sixty times a second cost more than all actions.
  const frames = new Map()
  window.requestAnimationFrame = callback => {
    effect()
    const id = later(() => {
      frames.delete(id)
      callback(performance.now())
    }, FRAME)
    frames.set(id, callback)
    return id
  }
  window.cancelAnimationFrame = id => {
    frames.delete(id)
    cancel(id)
  }
  // A canvas that waits for a frame already asks for no other: what it waits for is drawn before an action.
  const drawPending = () => {
    const pending = [...frames]
    frames.clear()
    for (const [id, callback] of pending) {
      cancel(id)
      callback(performance.now())
    }
  }
  const settle = async () => {
    const end = performance.now() + MAX_SETTLING
    do await new Promise(done => draw(() => later(done, 10)))
    while (requests > 0 && performance.now() < end)
  }
  addEventListener('hashchange', effect)
  new MutationObserver(records => { if (isArmed) effects += records.length }).observe(document, {
    attributes: true, characterData: true, childList: true, subtree: true,
  })
  // What happens in the task of an event and its promises is its effect; telemetry is drawn in other tasks.
  const channel = new MessageChannel()
  channel.port1.onmessage = () => { isArmed = false }
  for (const name of ['pointerdown', 'click', 'input', 'change']) addEventListener(name, event => {
    const control = event.target instanceof Element ? event.target.closest(SELECTOR) : null
    if (current === null || control === null) return
    if (control !== current.control && !control.contains(current.control) && !current.control.closest('label')?.contains(control)) return
    if (name === 'pointerdown' || name === 'click') drawPending()
    if (name !== 'pointerdown') used.add(current.key)
    isArmed = true
    channel.port2.postMessage(0)
  }, true)

  const scopeOf = () => {
    const dialogs = [...document.querySelectorAll('dialog[open], [role=dialog], [role=alertdialog]')].filter(isShown)
    return [dialogs.at(-1) ?? document.querySelector(root) ?? document.body, dialogs.length > 0]
  }
  // Toasts come and go beside what is used; a pointer passes through them here.
  const controlsIn = scope => [...scope.querySelectorAll(SELECTOR)].filter(each => isShown(each) && !each.closest('.toasts'))
  addEventListener('DOMContentLoaded', () => {
    const sheet = new CSSStyleSheet()
    sheet.replaceSync('.toasts, .toasts * { pointer-events: none !important }')
    document.adoptedStyleSheets.push(sheet)
  })
  const isWanted = each => {
    const key = keyOf(each)
    return isEnabled(each) && (again.has(key) || !used.has(key)) && (attempts.get(key) ?? 0) < MAX_ATTEMPTS && !excluded.test(key)
  }
  // The place of a control that a pointer reaches; null: something covers it.
  let cover = ''
  const placeOf = each => {
    const target = each.checkVisibility() && each.getBoundingClientRect().width > 1 ? each : each.closest('label') ?? each
    target.scrollIntoView({ block: 'center', inline: 'center', behavior: 'instant' })
    const { left, top, width, height } = target.getBoundingClientRect()
    const place = { x: left + Math.min(width / 2, 200), y: top + height / 2 }
    const hit = document.elementFromPoint(place.x, place.y)
    cover = hit === null ? 'outside of the screen' : `${hit.localName}.${hit.className}`
    return hit !== null && (target.contains(hit) || hit.contains(target) || each.closest('label')?.contains(hit)) ? place : null
  }
  // Places of a map to click on, for the tool that was chosen, or once in a round for all controls that wait for a
  // place; null: nothing waits, or there is no map.
  const placesFor = (scope, controls, isLeaving) => {
    const isTool = tool?.isConnected && tool.getAttribute('aria-pressed') === 'true'
    const waiting = controls.filter(each => !isEnabled(each) && !enabled.has(keyOf(each)) && !excluded.test(keyOf(each)))
    const reason = isTool ? `${round} ${keyOf(tool)}` : isLeaving && waiting.length > 0 ? `${round} ${waiting.map(keyOf)}` : null
    const canvas = [...scope.querySelectorAll('canvas.maplibregl-canvas')].find(isShown)
    if (reason === null || canvas === undefined || drawnFor.has(reason)) return null
    drawnFor.add(reason)
    const { left, top, width, height } = canvas.getBoundingClientRect()
    const places = CORNERS.map(([x, y]) => ({ x: left + x * width, y: top + y * height }))
    const free = places.filter(({ x, y }) => document.elementFromPoint(x, y) === canvas)
    return free.length > 0 ? free : null
  }
  const choose = each => {
    const key = keyOf(each), place = placeOf(each)
    attempts.set(key, again.delete(key) ? 0 : (attempts.get(key) ?? 0) + 1)
    current = { control: each, key, wasChosen: isChosen(each), isAgain: used.has(key) }
    effects = 0
    if (place === null) {
      problems.set(key, `covered by ${cover}`)
      return choice('covered')
    }
    problems.delete(key)
    if (each.classList.contains('guarded') && !LAST.test(key)) starters.add(key)
    return { ...choice(each.classList.contains('guarded') ? 'hold' : fill(each) ? 'filled' : 'click'), ...place }
  }
  const choice = action => ({ action, key: current.key })
  const setValue = (each, value) => {
    const owner = each.matches('textarea') ? HTMLTextAreaElement : each.matches('select') ? HTMLSelectElement : HTMLInputElement
    Object.getOwnPropertyDescriptor(owner.prototype, 'value').set.call(each, value)
    for (const name of ['input', 'change']) each.dispatchEvent(new Event(name, { bubbles: true }))
    return true
  }
  const STEPPED = new Set(['range', 'number'])
  const TEXTS = new Set(['text', 'textarea', 'password', 'url', 'date', 'time', 'color', 'email'])
  const fill = each => {
    if (each.matches('select')) {
      const options = [...each.options].filter(option => !option.disabled)
      // The second use goes back, since a choice may have removed other controls.
      const step = used.has(keyOf(each)) ? -1 : 1
      const next = options.at((options.indexOf(each.selectedOptions[0]) + step) % options.length)
      return setValue(each, next?.value ?? '')
    }
    if (!each.matches('input, textarea') || each.type === 'file') return false
    if (each.type === 'color') return setValue(each, '#336699')
    if (each.type === 'search') return setValue(each, '1') && setValue(each, '')
    if (STEPPED.has(each.type)) return setValue(each, each.value === each.max ? each.min || '0' : Number(each.value) ? each.value : each.min || '1')
    return TEXTS.has(each.type) && setValue(each, each.value || '1')
  }
  const unused = () => [...enabled].filter(key => !used.has(key) && !problems.has(key) && !excluded.test(key))
  // What another control disabled, or removed, may be there again; what opened or removed it is used once more.
  const idle = () => [...seen].filter(key => !enabled.has(key) && !used.has(key) && !excluded.test(key))
  const nextRound = () => {
    isStuck = used.size === usedBefore ? !isStuck : false
    // What the last actions have started may bring more controls, once.
    if ((round > 0 && unused().length + idle().length === 0) || round === MAX_ROUNDS || (used.size === usedBefore && !isStuck)) return null
    round += 1
    usedBefore = used.size
    reopened.clear()
    const isOver = isStuck && unused().length > 0
    // What a flight enables is gone after it: the flight is started once more.
    for (const key of isOver ? starters : []) {
      again.add(key)
      attempts.delete(key)
    }
    for (let key of isStuck ? [...unused(), ...idle()] : unused()) {
      // Where an opener does not bring a control back, the one that removed it may: a list with several modes.
      if (isStuck && removedBy.has(key)) {
        again.add(removedBy.get(key))
        attempts.delete(removedBy.get(key))
      }
      for (let depth = 0; depth < 4 && openedBy.has(key); depth += 1) {
        key = openedBy.get(key)
        again.add(key)
        attempts.delete(key)
      }
    }
    return { action: 'wait', key: '' }
  }
  // Ends the last action; returns whether it seems dead, so that what moves comes to rest before the second try.
  const finish = () => {
    if (current === null) return false
    const { control, key, wasChosen, isAgain } = current
    current = null
    last = key
    tool = control
    const isButton = control.matches('button, a, summary, [role=option]')
    const isDead = isButton && !isAgain && used.has(key) && !wasChosen && effects === 0
    if (isDead) {
      used.delete(key)
      problems.set(key, 'dead')
    }
    return isDead
  }
  window.crawler = {
    begin: (view, pattern) => { root = view; excluded = pattern === '' ? /(?!)/ : new RegExp(pattern); reopened.clear() },
    settle,
    held: () => { if (current !== null) { used.add(current.key); effects += 1 } },
    // Ends the last action, and chooses the next control; null: all are used.
    next: () => {
      if (finish()) return { action: 'wait', key: '' }
      if (document.fullscreenElement !== null) {
        document.exitFullscreen()
        return { action: 'wait', key: '' }
      }
      const [scope, isDialog] = scopeOf()
      const controls = controlsIn(scope)
      for (const each of controls) {
        const key = keyOf(each)
        if (!seen.has(key) && last !== null && last !== key) openedBy.set(key, last)
        seen.add(key)
        if (isEnabled(each)) enabled.add(key)
        if (nameOf(each) === '') nameless.add(`${keyOf(each)} ${each.outerHTML.slice(0, 80)}`)
      }
      const before = shown
      shown = new Set(controls.filter(isEnabled).map(keyOf))
      for (const key of before) if (!shown.has(key) && last !== null && last !== key) removedBy.set(key, last)
      const wanted = controls.filter(isWanted)
      const best = wanted.length > 0 ? wanted.reduce((first, each) => rank(each) < rank(first) ? each : first) : null
      const places = placesFor(scope, controls, best === null || rank(best) >= OPENER)
      if (places !== null) return { action: 'map', key: '', places }
      if (best !== null) return choose(best)
      if (isDialog) return { action: 'escape', key: 'dialog' }
      const opener = controls.find(each => isOpener(each) && isEnabled(each) && !isChosen(each) && !isOpen(each) && !excluded.test(keyOf(each)) && !reopened.has(keyOf(each)))
      if (opener === undefined) return nextRound()
      reopened.add(keyOf(opener))
      return choose(opener)
    },
    report: () => ({
      seen: [...seen], used: [...used], nameless: [...nameless],
      problems: [...problems].filter(([key]) => !used.has(key)).map(([key, problem]) => `${problem}: ${key}`),
      unused: unused(),
      idle: idle(),
    }),
  }
})()
