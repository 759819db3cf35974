"""A stand-in for WebSerial in pages under test."""

from __future__ import annotations

#: A port whose bytes go to the test's function `exchange`, which returns the answer; None: the port is lost.
PORT = """
(() => {
  let source = null
  const give = bytes => {
    if (bytes === null) {
      port.readable = null
      source?.error(new Error('The device has been lost.'))
      source = null
    } else if (bytes.length && source) source.enqueue(new Uint8Array(bytes))
  }
  const port = {
    readable: null, writable: null,
    async open() {
      this.readable = new ReadableStream({ start(each) { source = each } })
      this.writable = new WritableStream({ async write(data) { give(await window.exchange([...data])) } })
      const poll = async () => {
        if (source) give(await window.exchange([]))
        if (source) setTimeout(poll, 50)
      }
      setTimeout(poll, 50)
    },
    async close() { source = null; this.readable = this.writable = null },
    getInfo: () => ({ usbVendorId: 0x483, usbProductId: 0x5740 }),
  }
  const serial = { requestPort: async () => port, getPorts: async () => [port] }
  Object.defineProperty(navigator, 'serial', { value: serial })
})()
"""
