/** The members of a JSON object that people write: read one by one, with errors that name their place. */

export class DecoderError extends Error {}

const HEX = /^(?:\s*[0-9A-Fa-f]{2})*\s*$/;
const NAME = /^[A-Za-z][A-Za-z0-9_]{0,31}$/;
const MAX_SHOWN = 40;

export class Members {
  private readonly values: Readonly<Record<string, unknown>>;
  private readonly known: string[] = [];

  /** `place` says where the object is, such as `messages[0]`; empty: it is the whole. */
  constructor(
    value: unknown,
    private readonly place = '',
  ) {
    if (!isObject(value)) refuse(place, 'must be an object', value);
    this.values = value;
  }

  has(name: string): boolean {
    return this.take(name) !== null;
  }

  placeOf(name: string): string {
    return this.place === '' ? name : `${this.place}.${name}`;
  }

  integer(name: string, minimum: number, maximum: number, fallback?: number): number {
    const value = this.take(name, fallback);
    if (typeof value === 'number' && Number.isInteger(value) && value >= minimum && value <= maximum) return value;
    return refuse(this.placeOf(name), `must be a whole number from ${minimum} to ${maximum}`, value);
  }

  number(name: string, fallback: number): number {
    const value = this.take(name, fallback);
    if (typeof value === 'number' && Number.isFinite(value)) return value;
    return refuse(this.placeOf(name), 'must be a number', value);
  }

  choice<Word extends string>(name: string, choices: readonly Word[], fallback?: Word): Word {
    const value = this.take(name, fallback);
    const found = choices.find((each) => each === value);
    return found ?? refuse(this.placeOf(name), `must be one of ${choices.join(', ')}`, value);
  }

  text(name: string, maximum: number, fallback?: string): string {
    const value = this.take(name, fallback);
    if (typeof value === 'string' && value.length <= maximum) return value;
    return refuse(this.placeOf(name), `must be a text of at most ${maximum} characters`, value);
  }

  name(name: string, fallback?: string): string {
    const value = this.take(name, fallback);
    if (typeof value === 'string' && NAME.test(value)) return value;
    return refuse(this.placeOf(name), 'must be a name of letters, digits and _', value);
  }

  /** Returns bytes that are written in hexadecimal digits. */
  hexBytes(name: string, minimum: number, maximum: number, fallback?: string): Uint8Array {
    const value = this.take(name, fallback);
    if (typeof value !== 'string' || !HEX.test(value))
      return refuse(this.placeOf(name), 'must be bytes in hexadecimal digits such as aa55', value);
    const found = fromHex(value);
    if (found.length < minimum || found.length > maximum)
      refuse(this.placeOf(name), `must be ${minimum} to ${maximum} bytes`, value);
    return found;
  }

  /** Returns the objects of a list; a missing one is empty. */
  children(name: string, maximum: number): Members[] {
    const value = this.take(name, []);
    if (!Array.isArray(value) || value.length > maximum)
      return refuse(this.placeOf(name), `must be a list of at most ${maximum} objects`, value);
    return value.map((each, index) => new Members(each, `${this.placeOf(name)}[${index}]`));
  }

  child(name: string): Members {
    return new Members(this.take(name), this.placeOf(name));
  }

  /** Returns an object of texts; a missing one is empty. */
  texts(name: string, maximum: number): Readonly<Record<string, string>> {
    const value = this.take(name, {});
    if (!isObject(value) || Object.keys(value).length > maximum)
      return refuse(this.placeOf(name), `must be an object of at most ${maximum} texts`, value);
    for (const [key, text] of Object.entries(value)) {
      if (typeof text !== 'string') refuse(`${this.placeOf(name)}.${key.slice(0, MAX_SHOWN)}`, 'must be a text', text);
    }
    return value as Record<string, string>;
  }

  /** Refuses members that were not read. */
  end(): void {
    const unknown = Object.keys(this.values).find((name) => !this.known.includes(name));
    if (unknown === undefined) return;
    refuse(
      this.placeOf(unknown.slice(0, MAX_SHOWN)),
      `is not known here: there are ${this.known.join(', ')}`,
      undefined,
    );
  }

  /** Returns a member; null if it is missing and has no fallback. */
  private take(name: string, fallback: unknown = null): unknown {
    if (!this.known.includes(name)) this.known.push(name);
    return (Object.hasOwn(this.values, name) ? this.values[name] : null) ?? fallback;
  }
}

/** Throws the error of a place; the error shows a value that is not undefined. */
export function refuse(place: string, problem: string, value?: unknown): never {
  const got = value === null ? ': it is missing' : `, got ${JSON.stringify(value)?.slice(0, MAX_SHOWN)}`;
  throw new DecoderError(`${place === '' ? 'it' : place} ${problem}${value === undefined ? '' : got}`);
}

/** Returns the bytes of hexadecimal digits. */
export function fromHex(text: string): Uint8Array {
  const digits = text.replaceAll(/\s+/g, '');
  return Uint8Array.from({ length: digits.length / 2 }, (_, at) => parseInt(digits.slice(at * 2, at * 2 + 2), 16));
}

/** Returns bytes as hexadecimal digits. */
export function toHex(data: Uint8Array): string {
  return [...data].map((byte) => byte.toString(16).padStart(2, '0')).join(' ');
}

export function isHex(text: string): boolean {
  return HEX.test(text);
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}
