/** Reads the rows of one stream of lines. */
import { LineReader } from './LineReader';
import { parseRow, type Row, type RowTemplate } from './template';

export class LineRows {
  private readonly lines = new LineReader();
  private unread = 0;

  constructor(private readonly templates: readonly RowTemplate[]) {}

  /** Lines that fit no template, and lines that were too long. */
  get refused(): number {
    return this.lines.dropped + this.unread;
  }

  feed(data: Uint8Array): Row[] {
    const rows: Row[] = [];
    for (const line of this.lines.feed(data)) {
      const row = parseRow(this.templates, line);
      if (row === null) this.unread++;
      else rows.push(row);
    }
    return rows;
  }
}
