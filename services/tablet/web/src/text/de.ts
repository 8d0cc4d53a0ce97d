import type { Words } from './en';
import { formats } from './format';

const COUNTS = ['keiner Kamera', 'einer', 'zwei', 'drei', 'vier', 'fünf', 'sechs', 'sieben', 'acht'];

const listed = (numbers: number[]): string =>
  numbers.length < 2 ? numbers.join() : `${numbers.slice(0, -1).join(', ')} und ${numbers.at(-1)}`;

const phases: Words['phases'] = {
  connecting: { pill: 'Verbindet', title: 'Verbindung zur Box wird hergestellt', words: 'Einen Moment.' },
  offline: {
    pill: 'Keine Verbindung',
    title: 'Keine Verbindung zur Box',
    words: 'Neuer Versuch läuft. Ist die Box eingeschaltet und das Tablet in ihrem Netz?',
  },
  ended: {
    pill: 'Zu Ende',
    title: 'Die Wiedergabe ist zu Ende',
    words: 'Die nächste erscheint hier, sobald sie beginnt.',
  },
  failed: {
    pill: 'Ausgefallen',
    title: 'Die Box erzeugt keine Figur mehr',
    words: 'Ein Teil von ihr ist zu oft stehen geblieben und bleibt aus. Starten Sie die Box neu.',
  },
  searching: {
    pill: 'Wartet',
    title: 'Schüler wird gesucht',
    words: 'Die Figur erscheint, sobald zwei Kameras den Schüler sehen.',
  },
  waiting: {
    pill: 'Wartet',
    title: 'Niemand im Bild',
    words: 'Die Figur erscheint, sobald ein Schüler dort steht, wo zwei Kameras ihn sehen.',
  },
  stale: { pill: 'Unterbrochen', title: 'Keine neue Bewegung', words: 'Die graue Figur ist die zuletzt gesehene.' },
  late: {
    pill: 'Zu langsam',
    title: 'Bilder kommen zu spät an',
    words: 'Die Box, dieses Tablet oder das Netz kommt nicht nach.',
  },
  unable: {
    pill: 'Kein Bild',
    title: 'Dieses Tablet kann nicht in 3D zeichnen',
    words: 'Sein Browser hat kein WebGL 2. Aktualisieren Sie ihn oder nehmen Sie ein anderes Tablet.',
  },
  live: { pill: 'Live', title: '', words: '' },
};

const f = formats('de-DE', 'der Größe');

export const de: Words = {
  formats: f,
  product: 'KineBox',
  language: 'Sprache',
  close: 'Schließen',
  overdue: (what) => `${what}: Die Box hat es noch nicht übernommen`,
  side: 'Rückmeldung und Zustand des Raums',
  phases,
  gettingReady: { title: 'Die Kameras machen sich bereit', words: 'Einen Moment.' },
  lessonWaits: { title: 'Die Stunde beginnt gleich', words: 'Sie wartet, bis Versuche beurteilt werden können.' },
  late: {
    box: {
      title: 'Die Box ist ausgelastet',
      words: 'Sie hat zu viel zu tun, Bilder kommen zu spät, um gezeigt zu werden.',
    },
    tablet: {
      title: 'Dieses Tablet ist ausgelastet',
      words: 'Es hat zu viel zu tun, um die Bilder rechtzeitig zu zeigen. Schließen Sie andere Programme darauf.',
    },
    network: {
      title: phases.late.title,
      words: 'Box und Tablet kommen nach, das Netz vermutlich nicht. Gehen Sie näher an den Zugangspunkt.',
    },
    unknown: phases.late,
  },
  staleFor: (s) => (s ? `Keine neue Bewegung seit ${s === 1 ? 'einer Sekunde' : `${s} Sekunden`}` : phases.stale.title),

  lesson: {
    recording: 'Aufnahme',
    replay: (title) => ['Wiedergabe', title].filter(Boolean).join(' · '),
  },

  view: {
    label: 'Der Schüler in 3D',
    help: 'Ansicht mit den Pfeiltasten drehen, mit Plus und Minus näher und weiter, mit der Taste R zurück zur ersten Ansicht. Die Leertaste hält eine Wiederholung an und setzt sie fort, Escape beendet sie.',
    reset: 'Ansicht zurück',
    measured: 'Gesehen',
    unsure: 'Nicht sicher',
  },

  activity: {
    title: 'Übung',
    choose: 'Übung wählen',
    any: 'Jede Übung',
    anyShort: 'Jede',
    anyHint: 'Die Box erkennt, welche es ist',
    preset: 'Aus den Einstellungen',
    unknown: 'Nicht bekannt',
  },

  pupil: {
    title: 'Schüler/in',
    choose: 'Wer ist dran?',
    nobody: 'Niemand',
    nobodyHint: 'Versuche werden ohne Kürzel notiert',
    unknown: 'Nicht bekannt',
    is: (code) => `Schüler/in ${code}`,
    next: 'Nächste Person',
    nextIs: (code) => `Als Nächstes: ${code}`,
    another: 'Anderes Kürzel',
    take: 'Übernehmen',
    wrong:
      'Kein Kürzel. Ein Kürzel ist eine Zahl, auch mit Buchstaben: 7, 7B, B12, AB-12 oder 7B-12; höchstens 8 Zeichen.',
    privacy: 'Bitte nur Kürzel, keine Namen: Wer sich dahinter verbirgt, wissen nur Sie.',
    correct: (number) => `Wer machte Versuch ${number}?`,
    change: (who) => `${who}. Korrigieren`,
    notKept: 'Es wird nichts aufgenommen, deshalb kommt diese Korrektur in keinen Bericht.',
    perhapsKept:
      'Ob gerade aufgenommen wird, ist im Moment nicht bekannt, und damit auch nicht, ob diese Korrektur in einen Bericht kommt.',
  },

  feedback: {
    title: 'Letzter Versuch',
    earlier: (number) => `Versuch ${number}`,
    none: { title: 'Noch kein Versuch', words: 'Was zu ändern ist, steht hier eine Sekunde nach jedem Versuch.' },
    gone: {
      recorded: { title: 'Frühere Versuche stehen im Bericht', words: 'Der nächste Versuch erscheint wieder hier.' },
      lost: { title: 'Frühere Versuche sind nicht mehr bekannt', words: 'Der nächste Versuch erscheint wieder hier.' },
    },
    starting: { title: 'Macht sich bereit', words: 'Gleich werden Versuche beurteilt.' },
    off: { title: 'Versuche werden nicht beurteilt', words: 'Der Teil der Box, der sie beurteilt, arbeitet nicht.' },
    past: 'Von vor dem Abbruch der Verbindung',
    onlyNow: (activity) => `Jetzt zählt nur: ${activity}`,
    silence: {
      fine: 'Diesmal keine Korrektur',
      unsure: 'Diesmal nichts Klares zu korrigieren',
      unseen: 'Nicht gut genug gesehen, um zu urteilen',
    },
    rest: 'Der Rest war nicht gut genug zu sehen',
    wordless: 'Es gibt etwas zu korrigieren, aber die Worte dafür sind noch nicht da',
    score: 'Punkte',
    scoreOf: (value, sigma) => `${value} von 100, plus oder minus ${sigma}`,
    scoreUnknown: 'Punkte nicht bekannt',
    next: 'Nächstes Mal',
    verdicts: { good: 'Gut', fair: 'Fast', poor: 'Daran üben', unknown: 'Nicht bekannt' },
    measure: (value, sigma, unit) => `${value}${unit}, plus oder minus ${sigma}`,
  },

  attempts: {
    title: 'Versuche',
    none: 'Hier erscheinen die Versuche dieser Stunde.',
    anew: 'Neu beginnen',
    anewTitle: 'Mit leerer Liste beginnen?',
    anewWords: 'Die Liste wird auf allen Tablets geleert. Es wird nichts aufgenommen, diese Versuche sind dann weg.',
    keep: 'Liste behalten',
    show: (number, action, score, pupil) =>
      `Versuch ${number} noch einmal sehen: ${action}${pupil === null ? '' : `, Kürzel ${pupil}`}, ${score === null ? 'Punkte nicht bekannt' : `${score} Punkte`}`,
  },

  replay: {
    title: 'Zeitlupe',
    loading: 'Die Wiederholung kommt gleich',
    missing: 'Die Wiederholung dieses Versuchs gibt es nicht mehr',
    failed: 'Die Wiederholung kam nicht an',
    again: 'Noch einmal',
    back: 'Zurück zu Live',
    backThen: 'Zurück zur Stunde',
    play: 'Abspielen',
    pause: 'Anhalten',
    position: 'Stelle im Versuch',
    seconds: (at, length) => `${f.number(at, 1)} von ${f.number(length, 1)} Sekunden`,
    speedLabel: 'Tempo',
    keyframes: ['Start', 'Einsatz', 'Höhepunkt', 'Ende'],
    keyframeLabel: 'Gehe zu',
    standard: { ghost: 'Vorbild darüber', beside: 'Vorbild daneben', off: 'Ohne Vorbild' },
    mirror: 'Spiegeln',
    legend: {
      green: 'Wie es sein soll',
      yellow: 'Etwas daneben',
      red: 'Daneben',
      grey: 'Nicht sicher',
      standard: 'Vorbild',
      amiss: 'Abweichung',
    },
  },

  cameras: {
    title: 'Kameras',
    titleThen: 'Kameras in der Stunde',
    name: (index) => `Kamera ${index + 1}`,
    states: { ok: 'Gut', slow: 'Langsam', lost: 'Verloren', starting: 'Startet', unknown: 'Nicht bekannt' },
    reasons: {
      none: '',
      starting: 'Macht sich bereit',
      unheard: 'Ein Teil der Box steht still, über den man sie hört',
      given_up: 'Zu oft stehen geblieben; sie bleibt aus, bis die Box neu gestartet wird',
      never_seen: 'Seit dem Start der Box nichts gehört',
      process_gone: 'Ihr Programm ist stehen geblieben; die Box startet es neu',
      silent: 'Gibt kein Lebenszeichen',
      failed: 'Meldet einen Fehler',
      ended: 'Ihre Bilder haben aufgehört; Kabel und Strom prüfen',
      repeats: 'Sendet immer dasselbe Bild; ausstecken und wieder einstecken',
      clock: 'Ihre Uhr geht falsch; wenn das bleibt, ausstecken und wieder einstecken',
      no_frames: 'Sendet keine Bilder; Kabel prüfen',
      degraded: 'Arbeitet schlechter, als sie soll',
      behind: 'Kommt nicht nach',
      backlog: 'Ihre Bilder warten zu lange',
      sparse: 'Wenige Bilder pro Sekunde; schnelle Bewegungen können fehlen',
      resting: 'Ruht; andere Kameras sehen besser',
    },
    none: 'Ohne Verbindung nicht bekannt',
    lost: (lost, left) => {
      const who = lost.length === 1 ? `Kamera ${lost[0]} verloren` : `Kameras ${listed(lost)} verloren`;
      if (left >= 2) return `${who} – die Stunde geht mit ${COUNTS[left] ?? left} weiter`;
      return `${who} – für eine Figur braucht es zwei Kameras`;
    },
    givenUp: (numbers) =>
      numbers.length === 1
        ? `Kamera ${numbers[0]} kommt nicht von selbst zurück: prüfen, dann die Box neu starten.`
        : `Kameras ${listed(numbers)} kommen nicht von selbst zurück: prüfen, dann die Box neu starten.`,
    busy: 'Die Box ist ausgelastet – schnelle Bewegungen können fehlen',
    heldUp: (numbers) =>
      `Die Box kommt mit ${numbers.length === 1 ? 'Kamera' : 'den Kameras'} ${listed(numbers)} nicht nach`,
    slow: (slow, all) => {
      if (all) return 'Alle Kameras sind langsam – schnelle Bewegungen können fehlen';
      return slow.length === 1 ? `Kamera ${slow[0]} ist langsam` : `Kameras ${listed(slow)} sind langsam`;
    },
    then: {
      lost: (lost) =>
        lost.length === 1 ? `Kamera ${lost[0]} war hier verloren` : `Kameras ${listed(lost)} waren hier verloren`,
      busy: 'Die Box war hier ausgelastet – schnelle Bewegungen können fehlen',
      heldUp: (numbers) =>
        `Die Box kam hier mit ${numbers.length === 1 ? 'Kamera' : 'den Kameras'} ${listed(numbers)} nicht nach`,
      slow: (slow, all) => {
        if (all) return 'Alle Kameras waren hier langsam – schnelle Bewegungen können fehlen';
        return slow.length === 1 ? `Kamera ${slow[0]} war hier langsam` : `Kameras ${listed(slow)} waren hier langsam`;
      },
    },
  },

  troubles: {
    disk_full: 'Der Speicher ist voll – Stunden können nicht aufgenommen werden',
    disk_low: 'Der Speicher ist fast voll',
    memory_low: 'Die Box hat kaum noch Arbeitsspeicher – sie kann stehen bleiben',
    hot: 'Die Box ist zu heiß – sie kann langsam werden',
    throttled: 'Die Box ist zu heiß oder hat zu wenig Strom – sie ist langsam',
    clock_set: 'Die Uhr der Box wurde gestellt',
  },
  calibration: {
    cameras_exchanged: 'Zwei Kameras scheinen vertauscht – die Figur kann falsch sein',
    cameras_disagree: 'Die Kameras passen nicht zueinander – die Figur kann falsch sein',
    camera_moved: 'Eine Kamera wurde bewegt oder getauscht – die Figur kann falsch sein',
    remedy: 'Unter Details steht, welche Kameras es sind und was zu tun ist.',
  },

  readings: { title: 'Messwerte', rate: 'Figuren pro Sekunde', delay: 'Verzögerung' },

  details: {
    open: 'Details',
    title: 'Für die Technik',
    cameras: 'Kameras',
    processes: 'Programme der Box',
    connection: 'Dieses Tablet',
    box: 'Die Box',
    noData: 'Ohne Verbindung zur Box ist nichts bekannt.',
    legend: [
      ['Neu / gewünscht', 'Bilder pro Sekunde, die angesehen wurden und die die Box verlangt hat'],
      ['Wartet', 'wie lange ein Bild wartet, bis es angesehen wird'],
      ['Netz', 'thunder ist genau, lightning ist schnell'],
    ],
    columns: {
      camera: 'Kamera',
      fresh: 'Neu / gewünscht, Hz',
      source: 'Quelle, Hz',
      network: 'Netz',
      backlog: 'Wartet, ms',
      skipped: 'Ausgelassen',
      program: 'Programm',
      state: 'Zustand',
      processor: 'Kerne',
      memory: 'MB',
      restarts: 'Neustarts',
    },
    processStates: {
      ok: 'ok',
      starting: 'startet',
      degraded: 'eingeschränkt',
      failed: 'ausgefallen',
      silent: 'stumm',
      gone: 'fort',
      unknown: 'nicht bekannt',
    },
    live: 'Figuren pro Sekunde',
    latency: 'Alter der Figur am Server, Median / 95 %',
    delay: 'Alter der Figur auf diesem Bildschirm',
    roundTrip: 'Weg zur Box und zurück',
    drawn: 'Gezeichnete Figuren pro Sekunde',
    dropped: 'Als zu spät verworfen',
    unreadable: 'Nicht lesbar',
    processor: 'Prozessor belegt',
    temperature: 'Temperatur des Prozessors',
    memory: 'Arbeitsspeicher frei',
    disk: 'Speicher frei',
    clock: 'Datum und Uhrzeit der Box',
    version: 'Version',
    epoch: 'Film wiederholt',
    clients: 'Tablets',
    rejected: 'Abgelehnt von Bus / Tablets',
  },
};
