/** Items of Betaflight's on-screen display: where each one stands, and in which profiles it is shown. */

import type { ParameterTable } from './parameters';

export interface OsdItem {
  /** Name of the parameter. */
  readonly parameter: string;
  readonly number: number;
  readonly column: number;
  readonly row: number;
  /** Bits of the three profiles; 0: hidden. */
  readonly profiles: number;
  /** The form of the item. */
  readonly form: number;
}

const NAME = /^BF_OSD_(\d+)_POS$/;

/** Reads the number of MSP_OSD_CONFIG: five bits of column and row, a sixth bit of the column, profiles, form. */
export function readItem(parameter: string, number: number, bits: number): OsdItem {
  return {
    parameter,
    number,
    column: (bits & 31) | (((bits >> 10) & 1) << 5),
    row: (bits >> 5) & 31,
    profiles: (bits >> 11) & 7,
    form: (bits >> 14) & 3,
  };
}

export function writeItem({ column, row, profiles, form }: OsdItem): number {
  const [x, y] = [limited(column, 63), limited(row, 31)];
  return (x & 31) | (y << 5) | ((x >> 5) << 10) | (profiles << 11) | (form << 14);
}

/** Returns a number that fits its bits: others would change the neighbouring ones. */
function limited(value: number, maximum: number): number {
  return Math.max(0, Math.min(maximum, Math.round(value)));
}

export function osdItems(parameters: ParameterTable): OsdItem[] {
  return Object.values(parameters)
    .flatMap(({ name, value }) => {
      const match = NAME.exec(name);
      return match ? [readItem(name, Number(match[1]), value)] : [];
    })
    .sort((a, b) => a.number - b.number);
}
