// Functions of a page under test: its controls that can be seen, and the record of those that were used.
(() => {
  const SELECTOR = 'button, input, select, textarea, a[href], summary, [role=option], [role=slider]'
  const text = each => (each?.textContent ?? '').trim().replace(/\s+/g, ' ')
  const nameOf = each => {
    const ids = each.getAttribute('aria-labelledby')
    const labels = each.labels ? [...each.labels].map(text).join(' ') : ''
    const name = each.getAttribute('aria-label') || (ids && ids.split(' ').map(id => text(document.getElementById(id))).join(' ')) ||
      labels || (each.matches('input, select, textarea') ? '' : text(each)) || each.title || each.placeholder || ''
    return name.trim()
  }
  const general = name => name.replace(/\b[A-Z][A-Z0-9]*_[A-Z0-9_]+\b/g, 'NAME').replace(/[-+\u2212]?\d+(?:[.,:\u2009]\d+)*/g, '#').slice(0, 90)
  const kindOf = each => each.getAttribute('role') || (each.localName === 'input' ? each.type : each.localName)
  const keyOf = each => `${kindOf(each)}: ${general(nameOf(each))}`
  const isShown = each => each.checkVisibility({ visibilityProperty: true, opacityProperty: true }) &&
    (each.getBoundingClientRect().width > 0 || each.closest('label'))
  const used = each => {
    const control = each.target instanceof Element ? each.target.closest(SELECTOR) : null
    // Playwright selects an option, and chooses a file, by events of its own.
    if (control && (each.isTrusted || control.matches('select, [type=file]'))) window.recordControl(keyOf(control))
  }
  for (const name of ['click', 'input', 'change']) addEventListener(name, used, true)
  window.controlsOf = root => {
    for (const each of document.querySelectorAll('[data-crawled]')) delete each.dataset.crawled
    const dialogs = [...document.querySelectorAll('dialog[open], [role=dialog], [role=alertdialog]')].filter(isShown)
    const top = dialogs.at(-1)
    const inside = top ?? document.querySelector(root) ?? document.body
    return [...inside.querySelectorAll(SELECTOR)].filter(isShown).map((each, index) => {
      each.dataset.crawled = String(index)
      return {
        index, key: keyOf(each), name: nameOf(each), kind: kindOf(each), isDialog: top !== undefined,
        isEnabled: !each.matches(':disabled') && each.getAttribute('aria-disabled') !== 'true',
        isGuarded: each.classList.contains('guarded'),
        isOpener: each.matches('[role=tab], [aria-expanded], nav *, summary'),
      }
    })
  }
})()
