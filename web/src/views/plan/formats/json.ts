/** Checked reading of JSON that others wrote: errors name the place. */

export class PlanFileError extends Error {}

export type Json = null | boolean | number | string | readonly Json[] | { readonly [key: string]: Json };

/** A value in a file with the path to it. */
export class Tree {
  readonly value: Json | undefined;
  readonly path: string;

  constructor(value: Json | undefined, path = '') {
    this.value = value;
    this.path = path;
  }

  static parse(text: string): Tree {
    try {
      return new Tree(JSON.parse(text) as Json);
    } catch (error) {
      throw new PlanFileError(`the file is not JSON: ${(error as Error).message}`);
    }
  }

  wrong(reason: string): PlanFileError {
    return new PlanFileError(`${this.path || 'the file'}: ${reason}`);
  }

  get(key: string): Tree {
    const value = this.value;
    const inside = value !== null && typeof value === 'object' && !Array.isArray(value);
    const found = inside ? (value as Readonly<Record<string, Json>>)[key] : undefined;
    return new Tree(found, this.path ? `${this.path}.${key}` : key);
  }

  /** Returns the value of a key that must be there. */
  need(key: string): Tree {
    const found = this.get(key);
    if (found.value === undefined) throw this.wrong(`has no "${key}"`);
    return found;
  }

  get exists(): boolean {
    return this.value !== undefined && this.value !== null;
  }

  /** Returns the members of an array; none if it is missing. */
  list(): Tree[] {
    if (!this.exists) return [];
    if (!Array.isArray(this.value)) throw this.wrong('is not a list');
    return (this.value as readonly Json[]).map((each, index) => new Tree(each, `${this.path}[${index}]`));
  }

  number(): number {
    if (typeof this.value !== 'number' || !Number.isFinite(this.value)) throw this.wrong('is not a number');
    return this.value;
  }

  /** Returns a number; null, which stands for NaN, as it is. */
  numberOrNull(): number | null {
    return this.value === null ? null : this.number();
  }

  integer(minimum: number, maximum: number): number {
    const value = this.number();
    if (!Number.isInteger(value) || value < minimum || value > maximum) {
      throw this.wrong(`is ${value}, not a whole number between ${minimum} and ${maximum}`);
    }
    return value;
  }

  /** Returns a list of so many numbers, none of them null. */
  finite(count: number): number[] {
    const found = this.list().map((each) => each.number());
    if (found.length !== count) throw this.wrong(`has ${found.length} numbers instead of ${count}`);
    return found;
  }

  /** Returns a number, or a value if it is missing or null. */
  numberOr<T>(missing: T): number | T {
    return this.exists ? this.number() : missing;
  }

  /** Returns a list of so many numbers; null stands for NaN. */
  numbers(count: number): (number | null)[] {
    const found = this.list().map((each) => each.numberOrNull());
    if (found.length !== count) throw this.wrong(`has ${found.length} numbers instead of ${count}`);
    return found;
  }

  /** Returns a yes or no; some programs write 0 and 1. */
  flag(missing: boolean): boolean {
    if (this.value === undefined) return missing;
    if (typeof this.value === 'boolean' || this.value === 0 || this.value === 1) return Boolean(this.value);
    throw this.wrong('is not true or false');
  }

  text(): string {
    return typeof this.value === 'string' ? this.value : '';
  }
}
