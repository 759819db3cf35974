/** Where vehicles come from: the station's server, a serial port, a WebSocket, the demo in the page, or a log. */

import { api } from '$lib/api/client';
import { StationError } from '$lib/api/errors';
import { LinkTransport, parseLink } from '$lib/transport/LinkTransport';
import { MockTransport } from '$lib/transport/MockTransport';
import { ReplayTransport } from '$lib/transport/ReplayTransport';
import { WebSerialTransport } from '$lib/transport/WebSerialTransport';
import { WebSocketTransport } from '$lib/transport/WebSocketTransport';
import { LinkVehicle } from '$lib/vehicle/LinkVehicle';
import { ServerVehicle } from '$lib/vehicle/ServerVehicle';

import { ConflictWatch } from './conflicts';
import { fleet } from './fleet.svelte';
import { telemetryOf } from './replays';
import { status, type Role } from './status.svelte';

interface Session {
  readonly role: Role;
  readonly needs_password: boolean;
  readonly ticket?: string;
}

/** The serial port that was opened last; null without one. */
const serial: { current: WebSerialTransport | null } = { current: null };

/** The recording that is replayed, for the time bar; null without one. */
export const replay: { current: ReplayTransport | null } = { current: null };

const conflicts = new ConflictWatch(
  (system) => fleet.vehicle(system),
  () => status.link === 'open' && !status.needsLogin,
);

/** Connects to the station that served the page; asks for the password if it needs one. */
export async function startServer(): Promise<void> {
  leave();
  api.onUnauthorized = () => (status.needsLogin = true);
  const transport = new WebSocketTransport(undefined, { ticket });
  conflicts.start();
  await fleet.connect(transport, 'server', (heartbeat, send) => new ServerVehicle(heartbeat, send));
}

/** Opens a session with a password. */
export async function logIn(password: string): Promise<void> {
  const session = await api.post<Session>('session', { password });
  status.role = session.role;
  status.needsLogin = false;
  await startServer();
}

/**
 * Returns a ticket for the WebSocket, or null if the station is open; waits for ever while a password is asked: logging
 * in connects again.
 */
async function ticket(): Promise<string | null> {
  try {
    const session = await api.get<Session>('session');
    status.role = session.role;
    status.needsLogin = false;
    return session.ticket ?? null;
  } catch (error) {
    if (!(error instanceof StationError && error.kind === 'Unauthorized')) throw error;
    status.needsLogin = true;
    return new Promise(() => undefined);
  }
}

/** Starts the fleet of seven in the page, or any number of vehicles. */
export async function startDemo(count = 7): Promise<void> {
  leave();
  status.role = 'administer';
  await fleet.connect(new MockTransport(count), 'demo', (heartbeat, send) => new LinkVehicle(heartbeat, send));
}

/** Lets the user choose a serial port; must be called from a click. */
export async function startSerial(baudRate?: number): Promise<void> {
  const transport = new WebSerialTransport(baudRate);
  // First, so that a user who chooses no port, or one that is in use, stays where he is.
  await transport.choose();
  const { current } = serial;
  if (current?.shares(transport)) {
    current.close();
    await current.closed;
  }
  await transport.open();
  leave();
  serial.current = transport;
  status.role = 'administer';
  await fleet.connect(transport, 'serial', (heartbeat, send) => new LinkVehicle(heartbeat, send));
}

/** Reaches a vehicle without the station, by its WebSocket or the room of a relay; throws for any other address. */
export async function startLink(address: string): Promise<void> {
  const transport = new LinkTransport(parseLink(address));
  leave();
  status.role = 'administer';
  await fleet.connect(transport, 'link', (heartbeat, send) => new LinkVehicle(heartbeat, send));
}

/** Replays a log of any format; one that is not a telemetry log is turned into one by the station. */
export async function startReplay(given: Uint8Array, name: string): Promise<void> {
  const data = await telemetryOf(given, name);
  const transport = new ReplayTransport(data, name);
  if (transport.packets === 0)
    throw new StationError('InvalidArgumentError', `replaying ${name} failed: the file has no packets`);
  conflicts.stop();
  replay.current = transport;
  // The flight is over: no vehicle takes commands.
  status.role = 'observe';
  await fleet.connect(transport, 'replay', (heartbeat, send) => new LinkVehicle(heartbeat, send));
}

/** Lets go of the recording, which may be large, and of the station. */
function leave(): void {
  conflicts.stop();
  replay.current = null;
}

const MAX_DEMO_VEHICLES = 250;

/** Starts what the address asks for: `?demo`, `?demo=100` (vehicles), or the station. */
export async function start(search: string = location.search): Promise<void> {
  const demo = new URLSearchParams(search).get('demo');
  if (demo === null) await startServer();
  else await startDemo(Math.min(Math.max(Number(demo) || 7, 1), MAX_DEMO_VEHICLES));
}
