/** Lines of a stream of bytes, bounded in length, as the station reads them (`server/rows/lines.py`). */

const MAX_LINE = 4096;
const LINE_FEED = 10;

export class LineReader {
  /** Lines that were too long. */
  dropped = 0;
  private pending: number[] = [];
  private isSkipping = false;

  /** Returns the lines that bytes complete; bytes that are not UTF-8 become U+FFFD. */
  feed(data: Uint8Array): string[] {
    const lines: string[] = [];
    for (const byte of data) {
      if (byte === LINE_FEED) this.end(lines);
      else if (!this.isSkipping) this.take(byte);
    }
    return lines;
  }

  private take(byte: number): void {
    if (this.pending.length < MAX_LINE) {
      this.pending.push(byte);
      return;
    }
    this.pending = [];
    this.isSkipping = true;
    this.dropped++;
  }

  private end(lines: string[]): void {
    if (!this.isSkipping && this.pending.length > 0) {
      lines.push(new TextDecoder().decode(new Uint8Array(this.pending)).replace(/\r+$/, ''));
    }
    this.pending = [];
    this.isSkipping = false;
  }
}
