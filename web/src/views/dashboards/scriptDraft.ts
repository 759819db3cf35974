/** A script as its form holds it, with the inputs as lines of text. */
import { problemOf } from '$lib/scripts/sandbox';
import { formatFieldRef, parseFieldRef, type FieldRef } from '$lib/series/fieldRef';

import type { UserScript } from './model';

export interface ScriptDraft {
  name: string;
  inputs: string;
  frames: string;
  code: string;
}

export interface ReadScript {
  readonly script: UserScript | null;
  readonly problem: string | null;
}

export function draftOf({ name, inputs, frames, code }: UserScript): ScriptDraft {
  const lines = Object.entries(inputs).map(([input, ref]) => `${input} = ${formatFieldRef(ref)}`);
  return { name, inputs: lines.join('\n'), frames, code };
}

/** Returns the script of a form, or why it cannot run. */
export function readDraft({ name, inputs, frames, code }: ScriptDraft): ReadScript {
  if (!/^[A-Za-z][A-Za-z0-9_]{0,31}$/.test(name)) return { script: null, problem: 'the name has letters and digits' };
  const found = new Map<string, FieldRef>();
  for (const line of inputs.split('\n').filter((each) => each.trim() !== '')) {
    const [input = '', ...rest] = line.split('=');
    const ref = parseFieldRef(rest.join('='));
    if (ref === null || !/^\w{1,32}$/.test(input.trim()))
      return { script: null, problem: `${line.trim()} is not an input` };
    found.set(input.trim(), ref);
  }
  if (frames !== '' && !/^[A-Za-z][A-Za-z0-9_-]{0,31}$/.test(frames))
    return { script: null, problem: `${frames} is not the name of a source` };
  const problem = problemOf(code);
  return { script: problem === null ? { name, inputs: Object.fromEntries(found), frames, code } : null, problem };
}
