// The connection to rc10-web: it comes back by itself, and what the page knows of the robot is here.

import {
  type CheckedConfig,
  type Columns,
  type ConfigFile,
  type CurvePiece,
  type Diagnostics,
  type Down,
  type Hello,
  type Piece,
  type RecordedWords,
  type RecordingFile,
  type Response,
  type Robot,
  type RobotEvent,
  type ServerMessage,
  type State,
  type TestDone,
  type ViewAnswer,
  kProtocol,
  readColumns,
  readCurve,
  readPiece,
} from './protocol';

/** silent: rc10-web answers, and nothing comes of rc10d, or only what is old. */
export type Connection = 'connecting' | 'live' | 'silent' | 'lost';

export interface Known {
  connection: Connection;
  hello: Hello | null;
  /** The answer to a token that was shown: it is not rc10-web's. */
  tokenRefused: boolean;
  down: Down | null;
  robot: Robot | null;
  state: State | null;
  diagnostics: Diagnostics | null;
  events: RobotEvent[];
}

const kMaxEvents = 500;
const kFirstPauseMs = 500;
const kLongestPauseMs = 5000;
const kAnswerPatienceMs = 6000;
// rc10d's end and start are part of it: that of FileCall, and a little more.
const kHelperPatienceMs = 35_000;
// Longer than rc10-web's.
const kScanPatienceMs = 95_000;
// Beats, not milliseconds: a browser that stood still has heard nothing, and nobody was silent. States come 25 times
// a second, and rc10-web answers each beat.
const kBeatMs = 500;
const kSilentBeats = 4;
const kLostBeats = 8;
const kSleepMs = 1000;
const kMostRecordingBytes = 256 * 1024 * 1024;

type Listener = () => void;

export interface RobotRequest {
  operation: string;
  target?: string;
  values?: Record<string, number>;
}

/** A target of one motor while something is held. */
export interface Held {
  motor: string;
  mode: 'velocity' | 'current';
  value: number;
}

/** End of a test: its report and each tick of its curve, or why it did not begin. */
export type TestOutcome = { done: TestDone; curve: number[][] } | { refused: string };

/** rc10-web refuses tests of another one. */
const kTestSchema = 1;
const kRenewTestMs = 50;

function now_us(): number {
  return Math.round(performance.now() * 1000);
}

function failure(seq: number, message: string): Response {
  return { type: 'response', seq, status: 'failed', message, values: {}, heard: [] };
}

export class Link {
  readonly known: Known = {
    connection: 'connecting',
    hello: null,
    tokenRefused: false,
    down: null,
    robot: null,
    state: null,
    diagnostics: null,
    events: [],
  };

  /** Signals of the view that is drawn now. */
  shown: string[] = [];
  onView: (view: ViewAnswer) => void = () => {};

  private socket: WebSocket | null = null;
  private pauseMs = kFirstPauseMs;
  private readonly listeners = new Set<Listener>();
  private readonly columnListeners = new Set<(columns: Columns) => void>();
  private readonly open = new Map<number, (answer: Response) => void>();
  private readonly asked = new Map<number, (answer: RecordingFile[] | RecordedWords | null) => void>();
  private readonly configs = new Map<number, (answer: ConfigFile | CheckedConfig) => void>();
  private onPiece: (piece: Piece | string) => void = () => {};
  private test: {
    seq: number;
    onTime: (time_s: number, lasts_s: number) => void;
    onDone: (done: TestDone) => void;
    finish: (result: TestOutcome) => void;
  } | null = null;
  private onCurve: (piece: CurvePiece) => void = () => {};
  private seq = 0;
  private views = 0;
  private token: string | null = null;
  // A greeting comes first on each connection, and one in answer to each token.
  private greetings = 0;
  private tokens = 0;
  private beats = 0;
  private unheardBeats = 0;
  /** When this page's clock was 0. */
  private zeroMs = Date.now() - performance.now();
  private statelessBeats = 0;
  private drawn = false;

  connect(): void {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/link`);
    socket.binaryType = 'arraybuffer';
    this.unheardBeats = 0;
    if (this.beats === 0) this.beats = window.setInterval(() => this.beat(), kBeatMs);
    socket.onopen = () => {
      this.pauseMs = kFirstPauseMs;
      this.greetings = this.tokens = 0;
      const token = this.token ?? new URLSearchParams(location.hash.slice(1)).get('token') ?? location.hash.slice(1);
      if (token !== '') this.showToken(token);
      this.tellClock();
    };
    socket.onmessage = (message: MessageEvent<string | ArrayBuffer>) => this.take(message.data);
    socket.onclose = () => this.lost();
    this.socket = socket;
  }

  subscribe(listener: Listener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  addColumns(listener: (columns: Columns) => void): () => void {
    this.columnListeners.add(listener);
    return () => this.columnListeners.delete(listener);
  }

  /** Also after a connection that was lost. */
  showToken(token: string): void {
    this.token = token;
    if (this.send({ type: 'token', token })) ++this.tokens;
  }

  /** Number of the view: no other of this page has it, and so what still comes of one before is not taken for it. */
  view(signals: string[], columnUs: number, spanUs: number): number {
    const view = ++this.views;
    this.send({ type: 'view', view, signals, column_us: columnUs, span_us: spanUs });
    return view;
  }

  range(firstColumn: number, columnUs: number, count: number): void {
    this.send({ type: 'range', first_column: firstColumn, column_us: columnUs, count });
  }

  ask(request: RobotRequest, patienceMs = kAnswerPatienceMs): Promise<Response> {
    return this.askWithin(patienceMs, { type: 'request', target: '', values: {}, ...request });
  }

  /** Drives of a bus: rc10d listens for some seconds before it asks. */
  scan(request: RobotRequest): Promise<Response> {
    return this.ask(request, kScanPatienceMs);
  }

  /** A motor moves as long as this is renewed; each renewal counts for 150 ms from when it was sent. */
  hold(target: Held, onRefused: (why: string) => void): { renew: () => boolean; release: () => void } {
    const seq = ++this.seq;
    const tell = (held: boolean) =>
      this.send({ type: 'drive', seq, ...target, held, sent_us: now_us() });
    this.open.set(seq, (answer) => onRefused(answer.message));
    tell(true);
    return {
      renew: () => tell(true),
      release: () => {
        this.open.delete(seq);
        tell(false);
      },
    };
  }

  /**
   * A test of motion. It goes on as long as this page says so, and ends when the page is hidden or begins another one;
   * end() stops it. The curve is asked for piece by piece.
   */
  runTest(
    message: object,
    onTime: (time_s: number, lasts_s: number) => void,
  ): { end: (why: 'stopped' | 'left') => void; outcome: Promise<TestOutcome> } {
    // rc10-web keeps the numbers of one test for each page.
    this.test?.finish({ refused: 'another test of this page began' });
    const seq = ++this.seq;
    const end = (why: 'stopped' | 'left') => void this.send({ type: 'test_end', seq, why });
    const hidden = () => document.hidden && end('left');
    const left = () => end('left');
    document.addEventListener('visibilitychange', hidden);
    window.addEventListener('pagehide', left);
    const renewals = window.setInterval(() => this.send({ type: 'test_renewal', seq, sent_us: now_us() }), kRenewTestMs);
    const over = () => {
      clearInterval(renewals);
      document.removeEventListener('visibilitychange', hidden);
      window.removeEventListener('pagehide', left);
    };
    const outcome = new Promise<TestOutcome>((resolve) => {
      const finish = (result: TestOutcome) => {
        over();
        this.open.delete(seq);
        if (this.test?.seq === seq) {
          this.test = null;
          this.onCurve = () => {};
        }
        resolve(result);
      };
      this.open.set(seq, (answer) => finish({ refused: answer.message }));
      this.test = {
        seq,
        onTime,
        finish,
        onDone: (done) => {
          over();
          const curve: number[][] = [];
          const ticks = () => curve[0]?.length ?? 0;
          if (done.report.ticks === 0) return finish({ done, curve });
          this.onCurve = (piece) => {
            if (piece.seq !== seq || piece.first !== ticks()) return;
            piece.columns.forEach((column, i) => {
              const values = (curve[i] ??= []);
              for (const value of column) values.push(value);
            });
            if (ticks() >= done.report.ticks || piece.columns[0]?.length === 0) finish({ done, curve });
            else this.send({ type: 'curve', seq, first: ticks() });
          };
          this.send({ type: 'curve', seq, first: 0 });
        },
      };
      if (!this.send({ type: 'test', schema: kTestSchema, seq, sent_us: now_us(), ...message })) finish({ refused: 'no connection' });
    });
    return { end, outcome };
  }

  /** Null: no answer. */
  recordings(): Promise<RecordingFile[] | null> {
    return this.askFor<RecordingFile[]>({ type: 'recordings' });
  }

  /** Words for numbers of a recording; null: no answer. */
  words(of: { events: [number, number, number, string][]; buses: string[][]; frames: [number, boolean, string][] }): Promise<RecordedWords | null> {
    return this.askFor<RecordedWords>({ type: 'words', ...of });
  }

  /** A recording of the robot's computer; a text says why not. Another one ends this one. */
  recording(name: string, onShare: (share: number) => void): Promise<Uint8Array<ArrayBuffer> | string> {
    const number = ++this.seq;
    return new Promise((resolve) => {
      this.onPiece('');
      let file: Uint8Array<ArrayBuffer> | null = null;
      let got = 0;
      const done = (result: Uint8Array<ArrayBuffer> | string) => {
        this.open.delete(number);
        this.onPiece = () => {};
        resolve(result);
      };
      this.open.set(number, (answer) => done(answer.message));
      this.onPiece = (piece) => {
        if (typeof piece === 'string') return done(piece);
        if (piece.number !== number) return;
        if (!(piece.total <= kMostRecordingBytes && piece.offset + piece.bytes.length <= piece.total)) return done('');
        file ??= new Uint8Array(piece.total);
        file.set(piece.bytes, piece.offset);
        if (piece.offset === 0) return done(file);
        got += piece.bytes.length;
        onShare(got / piece.total);
        this.send({ type: 'piece', number });
      };
      if (!this.send({ type: 'recording', number, name })) done('no connection');
    });
  }

  /** The robot's file; a text says why not. */
  config(): Promise<ConfigFile | string> {
    return this.askOrHear<ConfigFile>({ type: 'config' });
  }

  /** Whether rc10d would accept this text; a text says why nobody knows. */
  checkConfig(text: string): Promise<CheckedConfig | string> {
    return this.askOrHear<CheckedConfig>({ type: 'config_check', text });
  }

  /** The root helper's answer: installing a text, or restarting rc10d. */
  changeFile(message: { type: 'config_install'; text: string; replaces: string } | { type: 'config_restart' }): Promise<Response> {
    return this.askWithin(kHelperPatienceMs, message);
  }

  /** Without an answer in time it has failed: nobody knows whether it was done. */
  private askWithin(patienceMs: number, message: object): Promise<Response> {
    const seq = ++this.seq;
    return new Promise((resolve) => {
      const done = (answer: Response) => {
        clearTimeout(timer);
        this.open.delete(seq);
        resolve(answer);
      };
      const timer = setTimeout(() => done(failure(seq, 'no answer')), patienceMs);
      this.open.set(seq, done);
      // rc10-web does nothing for a message that was held up.
      if (!this.send({ ...message, seq, sent_us: now_us() })) done(failure(seq, 'no connection'));
    });
  }

  private askOrHear<Answer extends ConfigFile | CheckedConfig>(message: object): Promise<Answer | string> {
    const seq = ++this.seq;
    return new Promise((resolve) => {
      const done = (answer: ConfigFile | CheckedConfig | string) => {
        this.open.delete(seq);
        this.configs.delete(seq);
        resolve(answer as Answer | string);
      };
      this.configs.set(seq, done);
      this.open.set(seq, (answer) => done(answer.message));
      if (!this.send({ ...message, seq })) done('no connection');
    });
  }

  private askFor<Answer extends RecordingFile[] | RecordedWords>(message: object): Promise<Answer | null> {
    const seq = ++this.seq;
    return new Promise((resolve) => {
      const done = (answer: RecordingFile[] | RecordedWords | null) => {
        clearTimeout(timer);
        this.asked.delete(seq);
        resolve(answer as Answer | null);
      };
      const timer = setTimeout(() => done(null), kAnswerPatienceMs);
      this.asked.set(seq, done);
      if (!this.send({ ...message, seq })) done(null);
    });
  }

  /** rc10-web measures the delay of this page's messages by it, and answers. */
  private tellClock(): void {
    this.send({ type: 'clock', sent_us: now_us() });
  }

  /** A cable that is out closes no connection: silence does. */
  private beat(): void {
    const { socket, known } = this;
    // A computer that slept: performance.now(), by which messages have their age, stood still meanwhile.
    const zeroMs = Date.now() - performance.now();
    const slept = Math.abs(zeroMs - this.zeroMs) > kSleepMs;
    this.zeroMs = zeroMs;
    if (socket === null) return;
    if (slept || ++this.unheardBeats > kLostBeats) {
      socket.onopen = socket.onmessage = socket.onclose = null;
      socket.close();
      return this.lost();
    }
    const awaited = known.connection === 'live' && known.robot !== null && known.down === null;
    if (awaited && ++this.statelessBeats > kSilentBeats) {
      known.state = null;
      known.connection = 'silent';
      this.changed();
    }
    this.tellClock();
  }

  private send(message: object): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  private lost(): void {
    // Beats count the silence of a connection, not of the pause before the next one.
    this.socket = null;
    this.known.connection = 'lost';
    this.known.state = null;
    for (const done of [...this.open.values()])
      done(failure(0, 'the connection was lost'));
    for (const done of [...this.asked.values()]) done(null);
    this.changed();
    setTimeout(() => this.connect(), this.pauseMs);
    this.pauseMs = Math.min(2 * this.pauseMs, kLongestPauseMs);
  }

  private take(data: string | ArrayBuffer): void {
    this.unheardBeats = 0;
    if (typeof data !== 'string') {
      const piece = readPiece(data);
      if (piece !== null) return this.onPiece(piece);
      const curve = readCurve(data);
      if (curve !== null) return this.onCurve(curve);
      const columns = readColumns(data);
      if (columns !== null) for (const listener of [...this.columnListeners]) listener(columns);
      return;
    }
    const message = JSON.parse(data) as ServerMessage;
    const known = this.known;
    switch (message.type) {
      case 'hello':
        // A page from before an upgrade.
        if (message.protocol !== kProtocol) return location.reload();
        known.hello = message;
        known.tokenRefused = message.right === 'nothing' && this.tokens > 0 && this.greetings >= this.tokens;
        ++this.greetings;
        known.connection = 'live';
        known.events = [];
        known.robot = null;
        known.diagnostics = null;
        break;
      case 'down':
        known.down = message;
        known.state = null;
        known.diagnostics = null;
        known.connection = 'live';
        break;
      case 'robot':
        this.statelessBeats = 0;
        known.robot = message;
        known.down = null;
        break;
      case 'state':
        this.statelessBeats = 0;
        known.state = message;
        known.down = null;
        known.connection = 'live';
        break;
      case 'diagnostics':
        known.diagnostics = message;
        break;
      case 'event':
        known.events = [message, ...known.events].slice(0, kMaxEvents);
        break;
      case 'view':
        this.shown = message.signals;
        this.onView(message);
        break;
      case 'recordings':
        this.asked.get(message.seq)?.(message.recordings);
        return;
      case 'words':
        this.asked.get(message.seq)?.(message);
        return;
      case 'config':
      case 'config_checked':
        this.configs.get(message.seq)?.(message);
        return;
      case 'test':
        if (this.test?.seq === message.seq) this.test.onTime(message.time_s, message.lasts_s);
        return;
      case 'test_done':
        if (this.test?.seq === message.seq) this.test.onDone(message);
        return;
      case 'clock':
        return;
      case 'response':
        this.open.get(message.seq)?.(message);
        this.asked.get(message.seq)?.(null);
        break;
    }
    this.changed();
  }

  // Once for each picture of the screen, however much arrives.
  private changed(): void {
    if (this.drawn) return;
    this.drawn = true;
    const draw = () => {
      this.drawn = false;
      for (const listener of this.listeners) listener();
    };
    if (document.hidden) setTimeout(draw, 250);
    else requestAnimationFrame(draw);
  }
}
