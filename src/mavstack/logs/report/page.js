// The charts of a report as an interactive page: one view of time for all charts, a cursor, and own fields.
"use strict"
{
  const SVG = "http://www.w3.org/2000/svg"
  const WIDTH = 860, HEIGHT = 190, LEFT = 52, RIGHT = 12, TOP = 12, BOTTOM = 24, COLOURS = 6
  const COLUMNS = WIDTH - LEFT - RIGHT
  const data = JSON.parse(document.getElementById("flight-data").textContent)
  const [begin, end] = data.span
  const view = { left: begin, right: end }
  let cursor = null
  const charts = []

  const numbers = (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))
    return new Float32Array(bytes.buffer)
  }
  const element = (name, attributes = {}, text = "") => {
    const made = document.createElementNS(SVG, name)
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value)
    if (text) made.textContent = text
    return made
  }
  const html = (name, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(name), properties)
    made.append(...children)
    return made
  }
  // The index of the first time that is not before `time`.
  const indexOf = (times, time) => {
    let low = 0, high = times.length
    while (low < high) {
      const middle = (low + high) >> 1
      if (times[middle] < time) low = middle + 1
      else high = middle
    }
    return low
  }
  const step = (span, count) => {
    const power = 10 ** Math.floor(Math.log10(span / count || 1))
    return power * ([5, 2].find((factor) => factor * power <= span / count) ?? 1)
  }
  const ticks = (low, high, count) => {
    const size = step(high - low, count), found = []
    for (let number = Math.ceil(low / size); number * size <= high; number++) found.push(number * size)
    return found
  }
  const shown = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(5))) : "–"
  const placeOf = (time) => LEFT + (time - view.left) / (view.right - view.left) * COLUMNS
  const timeAt = (svg, event) => {
    const box = svg.getBoundingClientRect()
    const share = ((event.clientX - box.left) / box.width * WIDTH - LEFT) / COLUMNS
    return view.left + Math.min(Math.max(share, 0), 1) * (view.right - view.left)
  }

  // The points of a line in the view: the lowest and the highest of each column of pixels.
  const visible = (line) => {
    const first = Math.max(indexOf(line.x, view.left) - 1, 0)
    const last = Math.min(indexOf(line.x, view.right) + 1, line.x.length)
    const size = Math.max(Math.ceil((last - first) / COLUMNS), 1), kept = []
    for (let start = first; start < last; start += size) {
      let low = -1, high = -1
      for (let index = start; index < Math.min(start + size, last); index++) {
        if (!Number.isFinite(line.y[index])) continue
        if (low < 0 || line.y[index] < line.y[low]) low = index
        if (high < 0 || line.y[index] > line.y[high]) high = index
      }
      if (low >= 0) kept.push(Math.min(low, high))
      if (high !== low) kept.push(Math.max(low, high))
    }
    return kept
  }

  const axes = (svg, low, high, y) => {
    // A number at the lower edge would touch those of the time.
    ticks(low, high, 4).filter((value) => y(value) < HEIGHT - BOTTOM - 14).forEach((value, number) => {
      svg.append(element("path", { class: "grid", d: `M${LEFT} ${y(value)}H${WIDTH - RIGHT}` }))
      const place = { class: number % 2 ? "y minor" : "y", x: LEFT - 6, y: y(value) + 4 }
      svg.append(element("text", place, shown(value)))
    })
    // A text at the right edge would be cut.
    ticks(view.left, view.right, 8).filter((value) => placeOf(value) < WIDTH - 24).forEach((value, number) => {
      const place = { class: number % 2 ? "x minor" : "x", x: placeOf(value), y: HEIGHT - 6 }
      svg.append(element("text", place, `${shown(value)} s`))
    })
  }
  const bands = (svg, vehicle) => {
    vehicle.modes.forEach(([start, stop, name], number) => {
      const from = Math.max(placeOf(start), LEFT), to = Math.min(placeOf(stop), WIDTH - RIGHT)
      if (to - from < 1) return
      const box = { class: `band b${number % 2}`, x: from, y: TOP, width: to - from }
      const band = element("rect", { ...box, height: HEIGHT - TOP - BOTTOM })
      band.append(element("title", {}, name))
      svg.append(band)
      if (to - from > 7 * name.length + 4) {
        svg.append(element("text", { class: "band", x: from + 3, y: TOP + 10 }, name))
      }
    })
  }
  const events = (svg, vehicle) => {
    for (const [time, kind, text] of vehicle.events) {
      if (time < view.left || time > view.right) continue
      const height = kind === "finding" ? HEIGHT - TOP - BOTTOM : 8
      const path = `M${placeOf(time)} ${HEIGHT - BOTTOM}v${-height}`
      const mark = element("path", { class: kind === "finding" ? "mark" : "event", d: path })
      mark.append(element("title", {}, `${shown(time)} s: ${text}`))
      svg.append(mark)
    }
  }

  const draw = (chart) => {
    const svg = chart.svg, drawn = chart.lines.map(visible)
    let low = Infinity, high = -Infinity
    drawn.forEach((kept, number) => {
      for (const index of kept) {
        low = Math.min(low, chart.lines[number].y[index])
        high = Math.max(high, chart.lines[number].y[index])
      }
    })
    if (low > high) [low, high] = [0, 1]
    const room = (high - low) * 0.05 || Math.abs(high) * 0.1 || 1
    low -= room
    high += room
    const y = (value) => HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)
    svg.replaceChildren()
    bands(svg, chart.vehicle)
    axes(svg, low, high, y)
    events(svg, chart.vehicle)
    const clip = element("g", { "clip-path": "url(#plot)" })
    drawn.forEach((kept, number) => {
      const line = chart.lines[number]
      const points = kept.map((index) => `${placeOf(line.x[index]).toFixed(1)},${y(line.y[index]).toFixed(1)}`)
      clip.append(element("polyline", { class: `line c${number % COLOURS}`, points: points.join(" ") }))
    })
    svg.append(clip)
    chart.cursor = element("path", { class: "cursor", d: "" })
    svg.append(chart.cursor)
  }

  // The cursor: a line in each chart, values in the legends, and a point on the track.
  const valueAt = (line) => {
    const index = indexOf(line.x, cursor)
    const before = Math.max(index - 1, 0), after = Math.min(index, line.x.length - 1)
    const nearest = cursor - line.x[before] < line.x[after] - cursor ? before : after
    return line.y[nearest]
  }
  const showCursor = () => {
    if (cursor === null) return
    slider.value = cursor
    const inView = cursor >= view.left && cursor <= view.right
    for (const chart of charts) {
      chart.cursor.setAttribute("d", inView ? `M${placeOf(cursor)} ${TOP}V${HEIGHT - BOTTOM}` : "")
      chart.lines.forEach((line, number) => { chart.values[number].textContent = shown(valueAt(line)) })
    }
    const states = data.vehicles.map((vehicle) => {
      const mode = vehicle.modes.findLast(([start]) => start <= cursor)
      const track = vehicle.track
      if (track) {
        const index = Math.min(indexOf(track.t, cursor), track.t.length - 1)
        track.point.setAttribute("cx", track.x[index])
        track.point.setAttribute("cy", track.y[index])
      }
      const near = vehicle.events.findLast(([time]) => time <= cursor)
      return [mode ? mode[2] : "", near ? `${near[2]} (${shown(near[0])} s)` : ""].filter(Boolean).join(" · ")
    })
    readout.textContent = [`${cursor.toFixed(2)} s`, ...states].filter(Boolean).join(" · ")
  }
  const redraw = () => {
    charts.forEach(draw)
    showCursor()
  }
  const show = (left, right) => {
    const span = Math.min(Math.max(right - left, 0.05), end - begin)
    view.left = Math.min(Math.max(left, begin), end - span)
    view.right = view.left + span
    redraw()
  }
  const zoom = (factor, about = cursor !== null && cursor > view.left && cursor < view.right ? cursor : (view.left + view.right) / 2) =>
    show(about - (about - view.left) * factor, about + (view.right - about) * factor)

  const listen = (chart) => {
    const svg = chart.svg
    let from = null, box = null
    const move = (event) => {
      cursor = timeAt(svg, event)
      if (from !== null) {
        const [left, right] = [Math.min(from, cursor), Math.max(from, cursor)]
        box.setAttribute("x", placeOf(left))
        box.setAttribute("width", placeOf(right) - placeOf(left))
      }
      showCursor()
    }
    svg.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return
      from = timeAt(svg, event)
      box = element("rect", { class: "selection", y: TOP, height: HEIGHT - TOP - BOTTOM, width: 0 })
      svg.append(box)
      svg.setPointerCapture(event.pointerId)
      move(event)
    })
    svg.addEventListener("pointermove", move)
    const stop = (event) => {
      if (from === null) return
      const to = timeAt(svg, event), wide = Math.abs(placeOf(to) - placeOf(from)) > 8
      const range = [Math.min(from, to), Math.max(from, to)]
      box.remove()
      from = null
      if (wide && event.type === "pointerup") show(...range)
    }
    svg.addEventListener("pointerup", stop)
    svg.addEventListener("pointercancel", stop)
    svg.addEventListener("dblclick", () => show(begin, end))
    svg.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey && !event.shiftKey) return
      event.preventDefault()
      const amount = event.deltaY || event.deltaX
      zoom(amount > 0 ? 1.25 : 0.8, timeAt(svg, event))
    }, { passive: false })
  }
  const add = (figure, vehicle, lines) => {
    const svg = figure.querySelector("svg"), keys = [...figure.querySelectorAll(".key")]
    const chart = { svg, vehicle, lines }
    chart.values = lines.map((_, number) => {
      const value = html("b", { className: "value" })
      ;(keys[number] ?? figure.querySelector("figcaption")).append(" ", value)
      return value
    })
    svg.classList.add("live")
    charts.push(chart)
    listen(chart)
    draw(chart)
    return chart
  }

  // Own fields: a tree of messages and their fields, of which each adds a chart.
  const fieldChart = (vehicle, table, field) => {
    const unit = field.unit ? html("small", { textContent: ` ${field.unit}` }) : ""
    const caption = html("figcaption", {}, `${table.name}.${field.name}`, unit)
    const svg = element("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${table.name}.${field.name}` })
    const figure = html("figure", {}, caption, svg)
    own.append(figure)
    table.times ??= numbers(table.t)
    field.values ??= numbers(field.y)
    const chart = add(figure, vehicle, [{ x: table.times, y: field.values }])
    showCursor()
    return () => {
      charts.splice(charts.indexOf(chart), 1)
      figure.remove()
    }
  }
  const own = html("div", { id: "own" })
  const tree = html("div", { className: "tree" })
  const leaf = (vehicle, table, field) => {
    const box = html("input", { type: "checkbox" })
    let remove = null
    box.addEventListener("change", () => {
      if (box.checked) remove = fieldChart(vehicle, table, field)
      else remove()
    })
    return html("label", { title: field.description ?? "" }, box, ` ${field.name}`, field.unit ? ` [${field.unit}]` : "")
  }
  const branch = (vehicle, table) => {
    const fields = html("div")
    const made = html("details", {}, html("summary", { textContent: table.name }), fields)
    made.fill = () => {
      if (!fields.childNodes.length) fields.append(...table.fields.map((field) => leaf(vehicle, table, field)))
    }
    made.addEventListener("toggle", made.fill)
    made.names = table.fields.map((field) => `${table.name}.${field.name}`.toLowerCase())
    return made
  }
  const branches = data.tables.map((table) => branch(data.vehicles[table.vehicle], table))
  tree.append(...branches)
  const filter = html("input", { type: "search", placeholder: "find a field", ariaLabel: "find a field" })
  filter.addEventListener("input", () => {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean)
    const fits = (name) => words.every((word) => name.includes(word))
    for (const made of branches) {
      made.hidden = !made.names.some(fits)
      made.open = words.length > 0 && !made.hidden
      made.fill()
      ;[...made.lastChild.children].forEach((label, number) => { label.hidden = !fits(made.names[number]) })
    }
  })

  // The tools: buttons, the time as a slider, and what was at the cursor.
  const button = (text, title, action) => {
    const made = html("button", { type: "button", textContent: text, title, ariaLabel: title })
    made.addEventListener("click", action)
    return made
  }
  const slider = html("input", { type: "range", min: begin, max: end, step: (end - begin) / 1000 || 1, value: begin, ariaLabel: "time" })
  slider.addEventListener("input", () => {
    cursor = Number(slider.value)
    showCursor()
  })
  const readout = html("output", { textContent: "move over a chart; drag to zoom; double-click: whole flight" })
  const shift = (share) => show(view.left + share * (view.right - view.left), view.right + share * (view.right - view.left))
  const tools = html("div", { className: "tools" },
    button("+", "zoom in", () => zoom(0.5)), button("−", "zoom out", () => zoom(2)),
    button("‹", "earlier", () => shift(-0.5)), button("›", "later", () => shift(0.5)),
    button("all", "whole flight", () => show(begin, end)), slider, readout)

  if (end > begin) {
    for (const vehicle of data.vehicles) {
      const track = vehicle.track
      if (!track) continue
      for (const name of ["t", "x", "y"]) track[name] = numbers(track[name])
      track.point = element("circle", { class: "cursor", r: 7, cx: track.x[0], cy: track.y[0] })
      document.querySelector(`svg.map[data-vehicle="${vehicle.number}"]`).append(track.point)
    }
    for (const figure of document.querySelectorAll("figure[data-chart]")) {
      const { vehicle, lines } = data.charts[figure.dataset.chart]
      add(figure, data.vehicles[vehicle], lines.map(({ x, y }) => ({ x: numbers(x), y: numbers(y) })))
    }
    const place = document.getElementById("tools")
    const shape = element("clipPath", { id: "plot" })
    shape.append(element("rect", { x: LEFT, y: 0, width: COLUMNS, height: HEIGHT }))
    const shapes = element("svg", { class: "shapes", width: 0, height: 0 })
    shapes.append(shape)
    place.append(tools, shapes)
    document.getElementById("fields").append(
      html("h2", { textContent: "Own fields" }), html("p", { className: "dim", textContent: "Each field that is chosen becomes a chart on the same axis of time." }), filter, tree, own)
  }
}
