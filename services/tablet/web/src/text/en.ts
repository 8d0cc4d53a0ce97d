/** Every word on the page. Another language is another file of this shape. */

import type { LateCause } from '../connection/lateness';
import type { Phase } from '../connection/phase';
import type { CalibrationCode, CameraStatus, MachineCode, ProcessStatus, Silence, Verdict } from '../protocol/messages';
import type { StandardShown } from '../replay/scene';
import { formats } from './format';

const COUNTS = ['no camera', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight'];

const listed = (numbers: number[]): string =>
  numbers.length < 2 ? numbers.join() : `${numbers.slice(0, -1).join(', ')} and ${numbers.at(-1)}`;

const reasons: Record<CameraStatus['reason'], string> = {
  none: '',
  starting: 'Getting ready',
  unheard: 'A part of the box stopped, through which it is heard',
  given_up: 'Stopped too often; the box leaves it off until it is started anew',
  never_seen: 'Not heard from since the box was started',
  process_gone: 'Its program stopped; the box restarts it',
  silent: 'Gives no sign of life',
  failed: 'Reports a failure',
  ended: 'Its pictures ended; check its cable and its power',
  repeats: 'Sends the same picture again and again; unplug it and plug it in again',
  clock: 'Its clock is wrong; if it stays so, unplug it and plug it in again',
  no_frames: 'Sends no pictures; check its cable',
  degraded: 'Works less well than it should',
  behind: 'Cannot keep up',
  backlog: 'Its pictures wait too long',
  sparse: 'Few pictures a second; fast movement may be missed',
  resting: 'Resting; other cameras see better',
};

const phases: Record<Phase, { pill: string; title: string; words: string }> = {
  connecting: { pill: 'Connecting', title: 'Connecting to the box', words: 'One moment.' },
  offline: {
    pill: 'No connection',
    title: 'No connection to the box',
    words: 'Trying again. Is the box switched on, and the tablet in its network?',
  },
  ended: { pill: 'Ended', title: 'The replay has ended', words: 'The next one is shown here as soon as it begins.' },
  failed: {
    pill: 'Failed',
    title: 'The box makes no figure any more',
    words: 'A part of it stopped too often and is given up. Start the box anew.',
  },
  searching: {
    pill: 'Waiting',
    title: 'Looking for the pupil',
    words: 'The figure appears as soon as two cameras see the pupil.',
  },
  waiting: {
    pill: 'Waiting',
    title: 'Nobody in view',
    words: 'The figure appears as soon as a pupil stands where two cameras see.',
  },
  stale: { pill: 'Interrupted', title: 'No new movement', words: 'The grey figure is the last that was seen.' },
  late: {
    pill: 'Too slow',
    title: 'Pictures arrive too late',
    words: 'The box, this tablet or the network cannot keep up.',
  },
  unable: {
    pill: 'No picture',
    title: 'This tablet cannot draw in 3D',
    words: 'Its browser has no WebGL 2. Update it, or use another tablet.',
  },
  live: { pill: 'Live', title: '', words: '' },
};

/** Who is to blame for pictures that arrive too late to be shown. */
const late: Record<LateCause, { title: string; words: string }> = {
  box: { title: 'The box is busy', words: 'It has too much to do, so pictures arrive too late to be shown.' },
  tablet: {
    title: 'This tablet is busy',
    words: 'It has too much to do to show the pictures in time. Close other programs on it.',
  },
  network: {
    title: phases.late.title,
    words: 'The box and this tablet keep up; the network probably does not. Move nearer to the access point.',
  },
  unknown: phases.late,
};

/** What is wrong with the machine: in the technician's list, and if it matters for the lesson, over the figure. */
const troubles: Record<MachineCode, string> = {
  disk_full: 'The disk is full – lessons cannot be recorded',
  disk_low: 'The disk is nearly full',
  memory_low: 'The box has hardly any memory left – it may stop',
  hot: 'The box is too hot – it may become slow',
  throttled: 'The box is too hot or has too little power – it is slow',
  clock_set: 'The clock of the box was set',
};

/** What speaks against the calibration; until somebody has seen to it, the figure may be wrong. */
const calibration: Record<CalibrationCode, string> = {
  cameras_exchanged: 'Two cameras seem to be exchanged – the figure may be wrong',
  cameras_disagree: 'The cameras do not agree with one another – the figure may be wrong',
  camera_moved: 'A camera was moved or exchanged – the figure may be wrong',
};

const f = formats('en-GB', 'of height');
const seconds = (s: number): string => (s === 1 ? '1 second' : `${s} seconds`);

export const en = {
  formats: f,
  product: 'KineBox',
  language: 'Language',
  close: 'Close',
  /** Something was asked of the box: an activity, a pupil, a correction. It may still be done. */
  overdue: (what: string): string => `${what}: the box has not taken it yet`,
  side: 'Feedback and state of the room',
  phases,
  gettingReady: { title: 'Cameras are getting ready', words: 'One moment.' },
  /** Of a lesson that is played. */
  lessonWaits: { title: 'The lesson begins in a moment', words: 'It waits until attempts can be judged.' },
  late,
  staleFor: (s: number | null): string => (s ? `No new movement for ${seconds(s)}` : phases.stale.title),

  lesson: {
    recording: 'Recording',
    replay: (title: string): string => ['Replay', title].filter(Boolean).join(' · '),
  },

  view: {
    label: 'The pupil in 3D',
    help: 'Turn the view with the arrow keys, come nearer with plus and minus, and go back to the first view with the key R. The space bar stops and starts a replay, Escape ends it.',
    reset: 'Reset view',
    measured: 'Seen',
    unsure: 'Not sure',
  },

  activity: {
    title: 'Activity',
    choose: 'Choose the activity',
    any: 'Any activity',
    /** Under the title. */
    anyShort: 'Any',
    anyHint: 'The box finds out which',
    /** The site file says so, and nobody has chosen it. */
    preset: 'From the settings',
    unknown: 'Not known',
  },

  pupil: {
    title: 'Pupil',
    choose: 'Who is up?',
    nobody: 'Nobody',
    nobodyHint: 'Attempts are noted without a code',
    unknown: 'Not known',
    is: (code: string): string => `Pupil ${code}`,
    next: 'Next pupil',
    nextIs: (code: string): string => `Next: pupil ${code}`,
    another: 'Another code',
    take: 'OK',
    wrong: 'Not a code. A code is a number, also with a letter: 7, 7B, B12, AB-12 or 7B-12; at most 8 characters.',
    privacy: 'Codes only, please, and no names: only you know who is behind a code.',
    correct: (number: number | string): string => `Whose was attempt ${number}?`,
    change: (who: string): string => `${who}. Correct it`,
    notKept: 'Nothing is being recorded, so this correction does not get into a report.',
    perhapsKept:
      'Whether anything is being recorded is not known right now, nor whether this correction gets into a report.',
  },

  feedback: {
    title: 'Last attempt',
    earlier: (number: number | string): string => `Attempt ${number}`,
    none: { title: 'No attempt yet', words: 'What to change stands here a second after each attempt.' },
    /** The page's server was started again and cannot list what was before; the lesson holds it, or nobody knows it any more. */
    gone: {
      recorded: { title: 'Earlier attempts are in the report', words: 'The next attempt is shown here again.' },
      lost: { title: 'Earlier attempts are not known any more', words: 'The next attempt is shown here again.' },
    },
    starting: { title: 'Getting ready', words: 'In a moment attempts are judged.' },
    off: { title: 'Attempts are not judged', words: 'The part of the box that judges them is not at work.' },
    past: 'From before the connection was lost',
    /** An attempt at something else is shown. */
    onlyNow: (activity: string): string => `Only this counts now: ${activity}`,
    /** What it means that nothing is corrected. */
    silence: {
      fine: 'No correction this time',
      unsure: 'Nothing clear to correct this time',
      unseen: 'Not seen well enough to judge',
    } satisfies Record<Silence, string>,
    /** The same where something was good, and too little else was seen. */
    rest: 'The rest was not seen well enough',
    /** What is to be corrected is known, and what is said about it is not. */
    wordless: 'There is something to correct, but the words for it are not here yet',
    score: 'Score',
    scoreOf: (value: string, sigma: string): string => `${value} of 100, give or take ${sigma}`,
    scoreUnknown: 'Score not known',
    next: 'Next time',
    verdicts: { good: 'Good', fair: 'Nearly', poor: 'Work on it', unknown: 'Not known' } satisfies Record<
      Verdict,
      string
    >,
    measure: (value: string, sigma: string, unit: string): string => `${value}${unit}, give or take ${sigma}`,
  },

  attempts: {
    title: 'Attempts',
    none: 'The attempts of this lesson will be listed here.',
    anew: 'Begin anew',
    anewTitle: 'Begin with an empty list?',
    anewWords: 'The list is emptied on all tablets. Nothing is being recorded, so these attempts are gone then.',
    keep: 'Keep the list',
    show: (number: number | string, action: string, score: string | null, pupil: string | null): string =>
      `See attempt ${number} again: ${action}${pupil === null ? '' : `, pupil ${pupil}`}, ${score === null ? 'score not known' : `score ${score}`}`,
  },

  replay: {
    title: 'Slow replay',
    loading: 'The replay is on its way',
    missing: 'The replay of this attempt is no longer there',
    failed: 'The replay did not arrive',
    again: 'Try again',
    back: 'Back to live',
    backThen: 'Back to the lesson',
    play: 'Play',
    pause: 'Pause',
    position: 'Moment of the attempt',
    seconds: (at: number, length: number): string => `${f.number(at, 1)} of ${f.number(length, 1)} seconds`,
    speedLabel: 'Speed',
    keyframes: ['Start', 'Effort', 'Peak', 'End'],
    keyframeLabel: 'Go to',
    standard: { ghost: 'Model on top', beside: 'Model beside', off: 'Hide model' } satisfies Record<
      StandardShown,
      string
    >,
    mirror: 'Mirror',
    legend: {
      green: 'As it should be',
      yellow: 'A little off',
      red: 'Off',
      grey: 'Not sure',
      standard: 'Model',
      amiss: 'How far off',
    },
  },

  cameras: {
    title: 'Cameras',
    titleThen: 'Cameras in the lesson',
    name: (index: number): string => `Camera ${index + 1}`,
    states: { ok: 'Good', slow: 'Slow', lost: 'Lost', starting: 'Starting', unknown: 'Not known' } satisfies Record<
      CameraStatus['state'],
      string
    >,
    reasons,
    none: 'Not known without a connection',
    /** One line for the teacher: who is missing, and whether the lesson can go on. */
    lost: (lost: number[], left: number): string => {
      const who = lost.length === 1 ? `Camera ${lost[0]} lost` : `Cameras ${listed(lost)} lost`;
      if (left >= 2) return `${who} – the lesson goes on with ${COUNTS[left] ?? left}`;
      return `${who} – two cameras are needed for a figure`;
    },
    givenUp: (numbers: number[]): string =>
      numbers.length === 1
        ? `Camera ${numbers[0]} does not come back by itself: check it, then start the box anew.`
        : `Cameras ${listed(numbers)} do not come back by themselves: check them, then start the box anew.`,
    busy: 'The box is busy – fast movement may be missed',
    heldUp: (numbers: number[]): string =>
      `The box cannot keep up with camera${numbers.length === 1 ? '' : 's'} ${listed(numbers)}`,
    slow: (slow: number[], all: boolean): string => {
      if (all) return 'All cameras are slow – fast movement may be missed';
      return slow.length === 1 ? `Camera ${slow[0]} is slow` : `Cameras ${listed(slow)} are slow`;
    },
    /** The same of a lesson that is played. */
    then: {
      lost: (lost: number[]): string =>
        lost.length === 1 ? `Camera ${lost[0]} was lost here` : `Cameras ${listed(lost)} were lost here`,
      busy: 'The box was busy here – fast movement may be missing',
      heldUp: (numbers: number[]): string =>
        `The box could not keep up with camera${numbers.length === 1 ? '' : 's'} ${listed(numbers)} here`,
      slow: (slow: number[], all: boolean): string => {
        if (all) return 'All cameras were slow here – fast movement may be missing';
        return slow.length === 1 ? `Camera ${slow[0]} was slow here` : `Cameras ${listed(slow)} were slow here`;
      },
    },
  },

  troubles,
  calibration: { ...calibration, remedy: 'Details say which cameras and what to do.' },

  readings: {
    title: 'Measurements',
    rate: 'Figures a second',
    delay: 'Delay',
  },

  details: {
    open: 'Details',
    title: 'For the technician',
    cameras: 'Cameras',
    processes: 'Programs of the box',
    connection: 'This tablet',
    box: 'The box',
    noData: 'Nothing is known without a connection to the box.',
    legend: [
      ['Fresh / wished', 'pictures a second that were looked at, and that the box asked for'],
      ['Waiting', 'how long a picture waits until it is looked at'],
      ['Network', 'thunder is exact, lightning is fast'],
    ],
    columns: {
      camera: 'Camera',
      fresh: 'Fresh / wished, Hz',
      source: 'Source, Hz',
      network: 'Network',
      backlog: 'Waiting, ms',
      skipped: 'Skipped',
      program: 'Program',
      state: 'State',
      processor: 'Cores',
      memory: 'MB',
      restarts: 'Restarts',
    },
    processStates: {
      ok: 'ok',
      starting: 'starting',
      degraded: 'degraded',
      failed: 'failed',
      silent: 'silent',
      gone: 'gone',
      unknown: 'not known',
    } satisfies Record<ProcessStatus['state'], string>,
    live: 'Figures a second',
    latency: 'Age of the figure at the server, median / 95 %',
    delay: 'Age of the figure on this screen',
    roundTrip: 'Way to the box and back',
    drawn: 'Figures drawn a second',
    dropped: 'Dropped as too late',
    unreadable: 'Could not be read',
    processor: 'Processor in use',
    temperature: 'Temperature of the processor',
    memory: 'Memory free',
    disk: 'Disk free',
    clock: 'Date and time of the box',
    version: 'Version',
    epoch: 'Footage repeated',
    clients: 'Tablets',
    rejected: 'Rejected from bus / tablets',
  },
};

export type Words = typeof en;
