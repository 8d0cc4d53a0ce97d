import {
  readServerMessage,
  type Ack,
  type Anew,
  type AttemptList,
  type Choose,
  type Correction,
  type Ping,
  type Status,
  type Turn,
} from '../protocol/messages';
import { BoxClock } from './boxClock';
import { reconnectDelayMs } from './reconnect';

const PING_PERIOD_MS = 2000;
/** The server speaks twice a second. After this silence the connection is dead, whatever the operating system believes. */
const SILENCE_MS = 4000;
const OPENING_MS = 5000;
/** What a server that is ended on purpose says at last. */
const GOODBYE = 1012;

export interface LinkEvents {
  /** A binary motion frame came. It counts as under way until `acknowledgeMotions`. */
  motion(buffer: ArrayBuffer): void;
  status(status: Status): void;
  /** The list of attempts, whole: once on connecting, and when it changes. */
  attempts(list: AttemptList): void;
  /** Connected, disconnected, or another attempt failed. */
  changed(): void;
}

/** The connection to the box: opens, watches and reopens the socket, acknowledges, and measures the way by ping. */
export class Link {
  readonly clock = new BoxClock();
  connected = false;
  everConnected = false;
  failures = 0;
  /** The connection is gone because the box's server was ended on purpose. */
  endedOnPurpose = false;

  private socket: WebSocket | null = null;
  private motions = 0;
  private statuses = 0;
  private heardMs = 0;
  private pings = new Map<number, number>();
  private nextPing = 0;
  private reopening: ReturnType<typeof setTimeout> | undefined;
  private watching: ReturnType<typeof setInterval> | undefined;

  constructor(
    private readonly url: string,
    private readonly events: LinkEvents,
  ) {}

  start(): void {
    this.open();
    this.watching = setInterval(() => this.watch(), PING_PERIOD_MS);
  }

  stop(): void {
    clearTimeout(this.reopening);
    clearInterval(this.watching);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  /** `count` motion frames were drawn, or dropped on purpose: the server may send as many more. */
  acknowledgeMotions(count: number): void {
    if (count === 0) return;
    this.motions += count;
    this.acknowledge();
  }

  /** What pupils shall do from now on; null is whatever the box recognises. */
  choose(activity: string | null): void {
    this.send({ type: 'choose', activity });
  }

  /** Who is up from now on; null is nobody who is named. */
  call(pupil: string | null): void {
    this.send({ type: 'turn', pupil });
  }

  /** Whose an attempt was after all. */
  correct(attempt: number, pupil: string | null): void {
    this.send({ type: 'correction', attempt, pupil });
  }

  /** The list of attempts shall begin anew. */
  beginAnew(): void {
    this.send({ type: 'anew' });
  }

  private open(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.heardMs = performance.now();
    // A socket that was given up may still report; only the current one is listened to.
    socket.onopen = () => {
      if (socket === this.socket) this.opened();
    };
    socket.onclose = ({ code }) => {
      if (socket === this.socket) this.closed(code);
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
      if (socket === this.socket) this.receive(event.data);
    };
  }

  private opened(): void {
    this.connected = true;
    this.everConnected = true;
    this.endedOnPurpose = false;
    this.failures = 0;
    this.motions = 0;
    this.statuses = 0;
    this.pings.clear();
    this.clock.reset();
    this.heardMs = performance.now();
    this.ping();
    this.events.changed();
  }

  private closed(code?: number): void {
    this.socket = null;
    this.connected = false;
    this.endedOnPurpose ||= code === GOODBYE;
    const delayMs = reconnectDelayMs(this.failures, Math.random());
    this.failures += 1;
    this.reopening = setTimeout(() => this.open(), delayMs);
    this.events.changed();
  }

  private receive(data: ArrayBuffer | string): void {
    this.heardMs = performance.now();
    if (typeof data !== 'string') {
      this.events.motion(data);
      return;
    }
    const message = readServerMessage(data);
    if (message?.type === 'status') {
      this.statuses += 1;
      this.acknowledge();
      this.events.status(message);
    } else if (message?.type === 'attempts') {
      this.events.attempts(message);
    } else if (message?.type === 'pong') {
      this.receivePong(message.id, message.box_time_us / 1000);
    }
  }

  private receivePong(id: number, boxMs: number): void {
    const sentMs = this.pings.get(id);
    if (sentMs === undefined) return;
    this.pings.clear(); // only the newest ping is answered
    this.clock.addPong(sentMs, boxMs, this.heardMs);
  }

  private watch(): void {
    const socket = this.socket;
    if (socket === null) return;
    const silenceMs = performance.now() - this.heardMs;
    if (silenceMs > (this.connected ? SILENCE_MS : OPENING_MS)) {
      this.closed();
      socket.close();
    } else if (this.connected) {
      this.ping();
    }
  }

  private ping(): void {
    const id = this.nextPing++;
    this.pings.set(id, performance.now());
    this.send({ type: 'ping', id });
  }

  private acknowledge(): void {
    this.send({ type: 'ack', motions: this.motions, statuses: this.statuses });
  }

  private send(message: Ack | Anew | Choose | Correction | Ping | Turn): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
