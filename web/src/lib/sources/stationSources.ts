/** The sources of the station, as far as the page needs them. */
import { api } from '$lib/api/client';
import { live } from '$lib/series/live.svelte';

export interface StationSource {
  readonly id: string;
  readonly url: string;
  readonly state: string;
  readonly rows?: {
    readonly name: string;
    readonly messages: Readonly<Record<string, readonly { readonly name: string; readonly unit: string }[]>>;
    readonly received: number;
    readonly refused: number;
  };
}

/** Returns the sources of the station, and remembers the units of their columns. */
export async function readSources(): Promise<readonly StationSource[]> {
  const sources = await api.get<readonly StationSource[]>('sources');
  for (const { rows } of sources) {
    for (const [message, columns] of Object.entries(rows?.messages ?? {})) live.setUnits(rows!.name, message, columns);
  }
  return sources;
}

/** A decoder of frames by its name, as sources name it by `decoder=NAME`. */
export interface NamedDecoder {
  readonly name: string;
  /** Its declaration (`$lib/frames/decoder.ts`). */
  readonly declaration: Readonly<Record<string, unknown>>;
}

/** Returns the request for a source: with the declaration of the decoder that its URL names, if it is known. */
export function sourceRequest(url: string, decoders: readonly NamedDecoder[]): Record<string, unknown> {
  const name = /^frames\+[^?]*\?(?:.*&)?decoder=([^&]+)/.exec(url)?.[1];
  const decoder = decoders.find((each) => each.name === name);
  return decoder === undefined ? { url } : { url, decoder: decoder.declaration };
}

/** Returns the URLs that a dashboard needs and the station does not have. */
export function missingSources(needed: readonly string[], sources: readonly Pick<StationSource, 'url'>[]): string[] {
  const known = new Set(sources.map(({ url }) => address(url)));
  return needed.filter((url) => !known.has(address(url)));
}

/** A URL without its options, in which the station may write a URL in another way. */
function address(url: string): string {
  return url.split('?')[0]!.replace(/\/+$/, '');
}
