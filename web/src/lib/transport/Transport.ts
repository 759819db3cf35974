/** The connection between the page and vehicles: bytes of whole or partial MAVLink packets in both directions. */

export type TransportState = 'closed' | 'connecting' | 'open' | 'failed';

export type DataListener = (data: Uint8Array, time: number) => void;
export type StateListener = (state: TransportState) => void;

/** Source and sink of MAVLink bytes. */
export interface Transport {
  /** Name for people, such as `ws://127.0.0.1:8080/ws` or `USB 26ac:0011`. */
  readonly name: string;
  readonly state: TransportState;
  /** Reason of the last failure, or null. */
  readonly reason: string | null;
  /** Opens the connection; resolves when bytes can be sent. Rejects with the reason if that is impossible. */
  open(): Promise<void>;
  close(): void;
  /** Sends whole packets; drops them while the connection is not open. */
  send(packets: Uint8Array): void;
  /** Registers a listener for received bytes and their time in ms since 1970; returns the function that removes it. */
  onData(listener: DataListener): () => void;
  onState(listener: StateListener): () => void;
  /** Returns the present time of what is received, in ms since 1970: that of the recording in a replay. */
  now(): number;
}

/** Listeners and state that all transports share. */
export abstract class BaseTransport implements Transport {
  abstract readonly name: string;
  private readonly dataListeners = new Set<DataListener>();
  private readonly stateListeners = new Set<StateListener>();
  private current: TransportState = 'closed';
  private why: string | null = null;

  abstract open(): Promise<void>;
  abstract close(): void;
  abstract send(packets: Uint8Array): void;

  get state(): TransportState {
    return this.current;
  }

  get reason(): string | null {
    return this.why;
  }

  onData(listener: DataListener): () => void {
    this.dataListeners.add(listener);
    return () => this.dataListeners.delete(listener);
  }

  onState(listener: StateListener): () => void {
    this.stateListeners.add(listener);
    return () => this.stateListeners.delete(listener);
  }

  now(): number {
    return Date.now();
  }

  protected emit(data: Uint8Array, time: number = Date.now()): void {
    for (const listener of this.dataListeners) listener(data, time);
  }

  protected change(state: TransportState, reason: string | null = null): void {
    this.why = reason;
    if (this.current === state) return;
    this.current = state;
    for (const listener of this.stateListeners) listener(state);
  }
}
