/** Metadata from files: PX4's component information (JSON) and ArduPilot's apm.pdef.json. */

import { EMPTY_METADATA, type MetadataTable, type ParameterMetadata } from './parameters';
import { ParameterFileError } from './parameterFiles';

type Facts = Readonly<Record<string, unknown>>;

/** Returns the metadata of a file by name; throws `ParameterFileError` if it has none. */
export function readMetadata(text: string): MetadataTable {
  let root: unknown;
  try {
    root = JSON.parse(text);
  } catch (error) {
    throw new ParameterFileError(`the file is not JSON: ${(error as Error).message}`);
  }
  const facts = object(root);
  const found = Array.isArray(facts.parameters) ? facts.parameters.map(component) : ardupilot(facts);
  const table = Object.fromEntries(found.filter((each) => each.name !== '').map((each) => [each.name, each]));
  if (Object.keys(table).length === 0) throw new ParameterFileError('the file has no metadata of parameters');
  return table;
}

function component(value: unknown): ParameterMetadata {
  const facts = object(value);
  const pairs = (list: unknown, key: string): Record<string, string> =>
    Object.fromEntries(
      (Array.isArray(list) ? list : []).map(object).map((each) => [String(each[key]), text(each.description)]),
    );
  return {
    ...EMPTY_METADATA,
    name: text(facts.name),
    short_description: text(facts.shortDesc),
    long_description: text(facts.longDesc),
    unit: text(facts.units),
    minimum: number(facts.min),
    maximum: number(facts.max),
    default: number(facts.default),
    increment: number(facts.increment),
    decimal_places: number(facts.decimalPlaces),
    values: pairs(facts.values, 'value'),
    bitmask: pairs(facts.bitmask, 'index'),
    reboot_required: facts.rebootRequired === true,
    read_only: facts.readOnly === true,
    volatile: facts.volatile === true,
    group: text(facts.group),
    category: text(facts.category),
  };
}

/** ArduPilot groups parameters by the beginnings of their names; the names there may have the vehicle before them. */
function ardupilot(root: Facts): ParameterMetadata[] {
  return Object.entries(root).flatMap(([group, members]) =>
    Object.entries(object(members))
      .filter(([, each]) => 'DisplayName' in object(each))
      .map(([name, each]) => {
        const facts = object(each);
        const range = object(facts.Range);
        return {
          ...EMPTY_METADATA,
          name: name.replace(/^.*:/, ''),
          short_description: text(facts.DisplayName),
          long_description: text(facts.Description),
          unit: text(facts.Units),
          minimum: number(range.low),
          maximum: number(range.high),
          increment: number(facts.Increment),
          values: texts(facts.Values),
          bitmask: texts(facts.Bitmask),
          reboot_required: /true/i.test(text(facts.RebootRequired)),
          read_only: /true/i.test(text(facts.ReadOnly)),
          group: group.replace(/_$/, ''),
          category: text(facts.User),
        };
      }),
  );
}

function object(value: unknown): Facts {
  return typeof value === 'object' && value !== null ? (value as Facts) : {};
}

function text(value: unknown): string {
  return typeof value === 'string' ? value.trim() : '';
}

function texts(value: unknown): Record<string, string> {
  return Object.fromEntries(Object.entries(object(value)).map(([key, each]) => [key, text(each)]));
}

function number(value: unknown): number | null {
  const found = typeof value === 'string' && value.trim() !== '' ? Number(value) : value;
  return typeof found === 'number' && Number.isFinite(found) ? found : null;
}
