/** Cameras that the station records: begun and ended here, or by other clients. */

import { api } from '$lib/api/client';

import type { VideoStream } from './streams';

export interface VideoRecording {
  readonly name: string;
  readonly size: number;
  readonly modified: number;
  readonly running: boolean;
  readonly seconds: number | null;
  /** Number of pictures that are in no file: the disk was too slow, or they were damaged. */
  readonly lost: number;
  readonly problem: string;
  /** The address of the camera without its password. */
  readonly uri: string;
}

const INTERVAL = 2000;

const SECRET_OPTION = /([?&][^=&]*(?:pass|secret|ticket|token|key|header\.)[^=&]*=)[^&]+/gi;

/** Returns an address as recordings name it: without user, password and secret options. */
export function withoutPassword(uri: string): string {
  return uri
    .trim()
    .replace(/\/\/.*@/, '//***@')
    .replace(SECRET_OPTION, '$1***');
}

class VideoRecordings {
  files = $state.raw<readonly VideoRecording[]>([]);

  /** The recording of a camera that runs; undefined: there is none. */
  of(uri: string): VideoRecording | undefined {
    return this.files.find((each) => each.running && each.uri === withoutPassword(uri));
  }

  /** Asks for them until the returned function is called. */
  follow(): () => void {
    const ask = (): void => void this.refresh().catch(() => undefined);
    ask();
    const timer = setInterval(ask, INTERVAL);
    return () => clearInterval(timer);
  }

  async refresh(): Promise<void> {
    this.files = await api.get<readonly VideoRecording[]>('video/recordings');
  }

  async start(system: number, { uri, name, isH265 }: Pick<VideoStream, 'uri' | 'name' | 'isH265'>): Promise<void> {
    await api.post('video/recordings', { uri, system, name: name.slice(0, 80), h265: isH265 ?? false });
    await this.refresh();
  }

  /** Ends a recording; returns the name of its last file. */
  async stop(name: string): Promise<string> {
    const ended = await api.post<VideoRecording>(`video/recordings/${encodeURIComponent(name)}/stop`);
    await this.refresh();
    return ended.name;
  }
}

export const recordings = new VideoRecordings();
