/** The command line interface of Betaflight and iNav: lines, replies and errors, as `mavstack.msp.cli` has them. */

const PROMPT = '\r\n# ';
export const MAX_LINE = 120;
const LEAVING: ReadonlySet<string> = new Set(['bl', 'bootloader', 'defaults', 'dfu', 'exit', 'msc', 'save']);
const MAX_TEXT = 4 << 20;

/** The text of an open CLI. A comment with a number behind each line shows where its reply ends. */
export class CliDialog {
  private text = '';
  private line = '';
  private marker = '';
  private number = 0;

  get atPrompt(): boolean {
    return this.text.endsWith(PROMPT);
  }

  receive(data: Uint8Array): void {
    this.text = (this.text + String.fromCharCode(...data)).slice(-MAX_TEXT);
  }

  /** Returns the text to send for a line. */
  send(line: string): string {
    checkLine(line);
    this.number += 1;
    this.line = line.trim();
    this.marker = `# end ${this.number}`;
    this.text = '';
    return isLeaving(line) ? `${this.line}\n` : `${this.line}\n${this.marker}\n`;
  }

  /** Returns the reply to the last line, without its echo; null: it is not complete. */
  reply(): string | null {
    const end = this.marker === '' ? -1 : this.text.indexOf(this.marker);
    if (end < 0) return null;
    let reply = this.text.slice(0, end);
    this.text = this.marker = '';
    if (reply.endsWith(PROMPT)) reply = reply.slice(0, -PROMPT.length);
    const echo = reply.indexOf(this.line);
    if (this.line !== '' && echo >= 0 && /^[\r\n# ]*$/.test(reply.slice(0, echo))) {
      reply = reply.slice(echo + this.line.length);
    }
    return reply
      .replaceAll('\r\n', '\n')
      .replaceAll('\r', '')
      .replace(/^\n+|\n+$/g, '');
  }
}

/** Throws a RangeError if the CLI does not take a line as it is. */
export function checkLine(line: string): void {
  if (line.length > MAX_LINE) throw new RangeError(`a line has at most ${MAX_LINE} characters`);
  if (!/^[ -~]*$/.test(line) || line.includes('?')) {
    throw new RangeError('a line is printable ASCII without “?”, which asks for completion');
  }
}

/** Returns whether a line restarts the firmware or leaves the CLI. */
export function isLeaving(line: string): boolean {
  const words = line.split('#')[0]!.toLowerCase().split(/\s+/).filter(Boolean);
  return LEAVING.has(words[0] ?? '') && !words.slice(1).some((word) => word === 'nosave' || word === 'noreboot');
}
