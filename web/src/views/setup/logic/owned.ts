/** Parameters that belong to one vehicle only, by the list of `mav param load`. */

import patterns from '../../../generated/owned.json';

/** Why: the vehicle counts or measures it itself, it is its id, or it belongs to its sensors. */
export type Owner = 'COUNTER' | 'IDENTITY' | 'CALIBRATION';

const OWNERS = (Object.keys(patterns) as Owner[]).map((owner) => {
  const each = patterns[owner].map((pattern) => pattern.replaceAll('*', '.*').replaceAll('?', '.'));
  return [owner, new RegExp(`^(?:${each.join('|')})$`, 'i')] as const;
});

/** Returns why a parameter belongs to one vehicle only; null if it may be set on any. */
export function ownerOf(name: string): Owner | null {
  return OWNERS.find(([, pattern]) => pattern.test(name))?.[0] ?? null;
}
