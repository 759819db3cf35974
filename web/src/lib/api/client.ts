/** The station's HTTP API: typed requests, errors as `StationError`, long work with progress. */

import { StationError } from './errors';

export type Query = Readonly<Record<string, string | number | boolean | undefined>>;
export type Progress = (done: number, total: number | null, step?: unknown) => void;

/** State of long work. */
export interface Task {
  readonly task: string;
  readonly name: string;
  readonly state: 'running' | 'done' | 'failed' | 'cancelled';
  readonly done: number;
  readonly total: number | null;
  /** The step at which the work is, where it has steps. */
  readonly step?: unknown;
}

interface Started {
  readonly task: string;
}

const INSTALLED_BASE = './api';
/** Times in ms: until the station answers, and until its connection for the progress of long work is there again. */
const ANSWER_TIMEOUT = 60_000;
const PROGRESS_TIMEOUT = 20_000;

export class ApiClient {
  private readonly base: string;
  private readonly fetcher: typeof fetch;
  /** Called when the session has ended; the page then asks for the password. */
  onUnauthorized: (() => void) | null = null;

  constructor(base: string = INSTALLED_BASE, fetcher: typeof fetch = (...request) => fetch(...request)) {
    this.base = base;
    this.fetcher = fetcher;
  }

  get<Result>(path: string, query: Query = {}): Promise<Result> {
    return this.json('GET', path, undefined, query);
  }

  post<Result>(path: string, body?: object, query: Query = {}): Promise<Result> {
    return this.json('POST', path, body, query);
  }

  /** Posts a file. */
  postBytes<Result>(path: string, body: Blob, query: Query = {}): Promise<Result> {
    return this.json('POST', path, body, query);
  }

  put<Result>(path: string, body: object | Blob, query: Query = {}): Promise<Result> {
    return this.json('PUT', path, body, query);
  }

  delete<Result>(path: string): Promise<Result> {
    return this.json('DELETE', path);
  }

  async bytes(path: string, query: Query = {}): Promise<Blob> {
    return (await this.request('GET', path, undefined, query)).blob();
  }

  /**
   * Does long work: starts it, tells its progress, and returns the answer that the request would have had.
   *
   * @param signal cancels the work at the station; the promise then rejects
   */
  async long(
    method: string,
    path: string,
    onProgress?: Progress,
    body?: object | Blob,
    query: Query = {},
    signal?: AbortSignal,
  ): Promise<Response> {
    const response = await this.request(method, path, body, { ...query, wait: false });
    if (response.status !== 202) return response;
    const { task } = (await response.json()) as Started;
    // The task tells that it was cancelled by its progress; one that ended before needs no answer.
    const cancel = (): void => void this.delete(`tasks/${task}`).catch(() => undefined);
    if (signal?.aborted === true) cancel();
    signal?.addEventListener('abort', cancel, { once: true });
    await this.follow(task, onProgress).finally(() => signal?.removeEventListener('abort', cancel));
    signal?.throwIfAborted();
    return this.request('GET', `tasks/${task}/result`);
  }

  /** Returns the JSON of long work. */
  async longJson<Result>(
    method: string,
    path: string,
    onProgress?: Progress,
    body?: object | Blob,
    query: Query = {},
  ): Promise<Result> {
    return (await (await this.long(method, path, onProgress, body, query)).json()) as Result;
  }

  url(path: string, query: Query = {}): string {
    const given = Object.entries(query).filter(([, value]) => value !== undefined);
    const search = new URLSearchParams(given.map(([name, value]) => [name, String(value)])).toString();
    return `${this.base}/${path}${search === '' ? '' : `?${search}`}`;
  }

  private async json<Result>(method: string, path: string, body?: object | Blob, query: Query = {}): Promise<Result> {
    return (await (await this.request(method, path, body, query)).json()) as Result;
  }

  private async request(method: string, path: string, body?: object | Blob, query: Query = {}): Promise<Response> {
    const headers: Record<string, string> = { Accept: 'application/json' };
    if (body !== undefined && !(body instanceof Blob)) headers['Content-Type'] = 'application/json';
    const sent = body === undefined ? null : body instanceof Blob ? body : JSON.stringify(body);
    const aborter = new AbortController();
    // An upload takes its time.
    const timer = sent instanceof Blob ? undefined : setTimeout(() => aborter.abort(), ANSWER_TIMEOUT);
    const { signal } = aborter;
    let response: Response;
    try {
      response = await this.fetcher(this.url(path, query), {
        method,
        headers,
        body: sent,
        credentials: 'same-origin',
        signal,
      });
    } catch {
      throw unreachable();
    } finally {
      clearTimeout(timer);
    }
    if (response.ok) return response;
    if (response.status === 401 && path !== 'session') this.onUnauthorized?.();
    throw await errorOf(response);
  }

  private follow(task: string, onProgress?: Progress): Promise<void> {
    return new Promise((resolve, reject) => {
      const events = new EventSource(this.url(`tasks/${task}/progress`));
      let timer: ReturnType<typeof setTimeout> | undefined;
      const close = (): void => {
        clearTimeout(timer);
        events.close();
      };
      const report = (event: MessageEvent<string>): void => {
        const state = JSON.parse(event.data) as Task;
        if (state.step === undefined) onProgress?.(state.done, state.total);
        else onProgress?.(state.done, state.total, state.step);
      };
      const end = (): void => {
        close();
        resolve();
      };
      const lose = (): void => {
        close();
        reject(unreachable());
      };
      events.addEventListener('progress', report);
      const fail = (event: MessageEvent<string>): void => {
        close();
        reject(errorIn(JSON.parse(event.data) as ErrorBody, ''));
      };
      events.addEventListener('failed', fail);
      for (const name of ['done', 'cancelled']) events.addEventListener(name, end);
      events.onopen = () => {
        clearTimeout(timer);
        timer = undefined;
      };
      events.onerror = () => {
        // The result tells why: the task is gone, or the session has ended.
        if (events.readyState === EventSource.CLOSED) end();
        // The browser tries again by itself.
        else timer ??= setTimeout(lose, PROGRESS_TIMEOUT);
      };
    });
  }
}

function unreachable(): StationError {
  return new StationError('Unreachable', 'the station does not answer');
}

interface ErrorBody {
  readonly error?: {
    readonly kind?: string;
    readonly text?: string;
    readonly code?: number;
    readonly status_texts?: readonly string[];
  };
}

async function errorOf(response: Response): Promise<StationError> {
  let body: ErrorBody = {};
  try {
    body = (await response.json()) as ErrorBody;
  } catch {
    // A proxy's own page.
  }
  return errorIn(body, `the station answered ${response.status} ${response.statusText}`.trim());
}

function errorIn(body: ErrorBody, fallback: string): StationError {
  const { kind, text, status_texts: texts, code } = body.error ?? {};
  return new StationError(kind ?? 'InternalError', text ?? fallback, texts ?? [], code ?? null);
}

/** The client of the station that served the page. */
export const api = new ApiClient();
