/**
 * Templates of lines of text with separated values: which column is which field of which message.
 *
 *     time:s,lat:deg,lon:deg,alt:m*0.001     names with units and factors
 *     $IMU,roll:deg,pitch:deg                a line that begins with `$IMU` is the message IMU
 *     $GPS,lat,lon|$IMU,roll,pitch           several messages
 *     temperature;_;pressure                 `_` leaves a column out; the first of , ; tab space separates
 *
 * The server reads lines by the same rules (`mavstack.server.rows.template`); `template-cases.json` tests both.
 */
export interface Column {
  readonly name: string;
  readonly unit: string;
  readonly factor: number;
}

export interface RowTemplate {
  /** Name of the message: `ROW` without a constant at the beginning. */
  readonly message: string;
  /** The constant that begins the line, null if there is none. */
  readonly constant: string | null;
  readonly separator: string;
  /** A column without a name (`_`) is null. */
  readonly columns: readonly (Column | null)[];
}

export interface Row {
  readonly message: string;
  readonly fields: Record<string, number | string>;
}

export class TemplateError extends Error {}

const SEPARATORS = [',', ';', '\t', ' '];
const NAME = /^[A-Za-z][A-Za-z0-9_]{0,31}$/;
const CONSTANT = /^\$[A-Za-z0-9_]{1,31}$/;
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;
const MAX_COLUMNS = 128;

/** Returns the templates of a text; throws a TemplateError that says what is wrong. */
export function parseTemplates(text: string): RowTemplate[] {
  const templates = text.split('|').map((part) => parseTemplate(part.trim()));
  const constants = templates.map((each) => each.constant);
  if (new Set(constants).size < constants.length) throw new TemplateError('two templates begin in the same way');
  return templates;
}

function parseTemplate(text: string): RowTemplate {
  if (text === '') throw new TemplateError('a template names the columns, such as time:s,lat:deg,lon:deg');
  const separator = SEPARATORS.find((each) => text.includes(each)) ?? ',';
  const words = split(text, separator);
  const constant = words[0]!.startsWith('$') ? words.shift()! : null;
  if (constant !== null && !CONSTANT.test(constant))
    throw new TemplateError(`${constant} is not a constant such as $GPS`);
  if (words.length === 0 || words.length > MAX_COLUMNS) {
    throw new TemplateError(`a template has 1 to ${MAX_COLUMNS} columns, got ${words.length}`);
  }
  const columns = words.map(parseColumn);
  refuseRepeated(columns);
  return { message: constant === null ? 'ROW' : constant.slice(1), constant, separator, columns };
}

function parseColumn(word: string): Column | null {
  if (word === '_') return null;
  const [rest, factorText, ...more] = word.split('*');
  const [name, ...units] = rest!.split(':');
  if (!NAME.test(name!) || more.length > 0 || units.length > 1) {
    throw new TemplateError(`${JSON.stringify(word)} is not a column such as alt, alt:m or alt:m*0.001`);
  }
  if (factorText !== undefined && !NUMBER.test(factorText)) {
    throw new TemplateError(`the factor of ${name} must be a number, got ${JSON.stringify(factorText)}`);
  }
  return { name: name!, unit: units[0] ?? '', factor: factorText === undefined ? 1 : Number(factorText) };
}

function refuseRepeated(columns: readonly (Column | null)[]): void {
  const names = columns.flatMap((column) => (column === null ? [] : [column.name]));
  const repeated = names.find((name, index) => names.indexOf(name) < index);
  if (repeated !== undefined) throw new TemplateError(`the column ${repeated} is named twice`);
  if (names.length === 0) throw new TemplateError('no column has a name');
}

/** Returns the row of a line, null if no template fits. */
export function parseRow(templates: readonly RowTemplate[], line: string): Row | null {
  for (const template of templates) {
    const words = split(line.trim(), template.separator);
    if (template.constant !== null && words.shift() !== template.constant) continue;
    if (words.length !== template.columns.length) continue;
    return { message: template.message, fields: fieldsOf(template, words) };
  }
  return null;
}

function split(text: string, separator: string): string[] {
  // Columns that are aligned with spaces have several between them.
  return text.split(separator === ' ' ? / +/ : separator).map((word) => word.trim());
}

function fieldsOf(template: RowTemplate, words: readonly string[]): Record<string, number | string> {
  const fields: Record<string, number | string> = {};
  template.columns.forEach((column, index) => {
    const word = words[index]!;
    if (column === null || word === '') return;
    const value = NUMBER.test(word) ? Number(word) * column.factor : word;
    if (typeof value === 'string' || Number.isFinite(value)) fields[column.name] = value;
  });
  return fields;
}
