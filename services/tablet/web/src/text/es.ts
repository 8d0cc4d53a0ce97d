import type { Words } from './en';
import { formats } from './format';

const COUNTS = ['ninguna', 'una', 'dos', 'tres', 'cuatro', 'cinco', 'seis', 'siete', 'ocho'];

const listed = (numbers: number[]): string =>
  numbers.length < 2 ? numbers.join() : `${numbers.slice(0, -1).join(', ')} y ${numbers.at(-1)}`;

const phases: Words['phases'] = {
  connecting: { pill: 'Conectando', title: 'Conectando con la caja', words: 'Un momento.' },
  offline: {
    pill: 'Sin conexión',
    title: 'Sin conexión con la caja',
    words: 'Se intenta de nuevo. ¿Está encendida la caja y la tableta en su red?',
  },
  ended: {
    pill: 'Terminado',
    title: 'La reproducción ha terminado',
    words: 'La siguiente se muestra aquí en cuanto empiece.',
  },
  failed: {
    pill: 'Fallo',
    title: 'La caja ya no genera la figura',
    words: 'Una parte se detuvo demasiadas veces y queda apagada. Reinicie la caja.',
  },
  searching: {
    pill: 'Esperando',
    title: 'Buscando al alumno',
    words: 'La figura aparece en cuanto dos cámaras ven al alumno.',
  },
  waiting: {
    pill: 'Esperando',
    title: 'Nadie a la vista',
    words: 'La figura aparece en cuanto un alumno está donde lo ven dos cámaras.',
  },
  stale: { pill: 'Interrumpido', title: 'Sin movimiento nuevo', words: 'La figura gris es la última que se vio.' },
  late: {
    pill: 'Demasiado lento',
    title: 'Las imágenes llegan tarde',
    words: 'La caja, esta tableta o la red no dan abasto.',
  },
  unable: {
    pill: 'Sin imagen',
    title: 'Esta tableta no puede dibujar en 3D',
    words: 'Su navegador no tiene WebGL 2. Actualícelo o use otra tableta.',
  },
  live: { pill: 'En directo', title: '', words: '' },
};

const f = formats('es-ES', 'de estatura');
const seconds = (s: number): string => (s === 1 ? '1 segundo' : `${s} segundos`);

export const es: Words = {
  formats: f,
  product: 'KineBox',
  language: 'Idioma',
  close: 'Cerrar',
  overdue: (what) => `${what}: la caja aún no lo ha aceptado`,
  side: 'Comentarios y estado de la sala',
  phases,
  gettingReady: { title: 'Las cámaras se están preparando', words: 'Un momento.' },
  lessonWaits: { title: 'La clase empieza enseguida', words: 'Espera a que se puedan evaluar los intentos.' },
  late: {
    box: {
      title: 'La caja está ocupada',
      words: 'Tiene demasiado que hacer y las imágenes llegan tarde para mostrarlas.',
    },
    tablet: {
      title: 'Esta tableta está ocupada',
      words: 'Tiene demasiado que hacer para mostrar las imágenes a tiempo. Cierre otros programas.',
    },
    network: {
      title: phases.late.title,
      words: 'La caja y esta tableta dan abasto; la red probablemente no. Acérquese al punto de acceso.',
    },
    unknown: phases.late,
  },
  staleFor: (s) => (s ? `Sin movimiento nuevo desde hace ${seconds(s)}` : phases.stale.title),

  lesson: {
    recording: 'Grabando',
    replay: (title) => ['Repetición', title].filter(Boolean).join(' · '),
  },

  view: {
    label: 'El alumno en 3D',
    help: 'Gire la vista con las flechas, acérquese y aléjese con más y menos, y vuelva a la primera vista con la tecla R. La barra espaciadora detiene y reanuda una repetición; Escape la termina.',
    reset: 'Vista inicial',
    measured: 'Visto',
    unsure: 'No seguro',
  },

  activity: {
    title: 'Actividad',
    choose: 'Elegir la actividad',
    any: 'Cualquier actividad',
    anyShort: 'Cualquiera',
    anyHint: 'La caja reconoce cuál es',
    preset: 'Según los ajustes',
    unknown: 'Desconocida',
  },

  pupil: {
    title: 'Alumno/a',
    choose: '¿A quién le toca?',
    nobody: 'Nadie',
    nobodyHint: 'Los intentos se anotan sin código',
    unknown: 'No se sabe',
    is: (code) => `Alumno/a ${code}`,
    next: 'El siguiente',
    nextIs: (code) => `Siguiente: ${code}`,
    another: 'Otro código',
    take: 'Aceptar',
    wrong:
      'No es un código. Un código es un número, también con letra: 7, 7B, B12, AB-12 o 7B-12; 8 caracteres como máximo.',
    privacy: 'Solo códigos, por favor, sin nombres: solo usted sabe a quién corresponde cada código.',
    correct: (number) => `¿De quién fue el intento ${number}?`,
    change: (who) => `${who}. Corregir`,
    notKept: 'No se está grabando nada, así que esta corrección no llegará a ningún informe.',
    perhapsKept: 'Ahora mismo no se sabe si se está grabando, ni si esta corrección llegará a un informe.',
  },

  feedback: {
    title: 'Último intento',
    earlier: (number) => `Intento ${number}`,
    none: { title: 'Aún no hay intentos', words: 'Qué cambiar aparece aquí un segundo después de cada intento.' },
    gone: {
      recorded: {
        title: 'Los intentos anteriores están en el informe',
        words: 'El próximo intento volverá a aparecer aquí.',
      },
      lost: { title: 'Los intentos anteriores ya no se conocen', words: 'El próximo intento volverá a aparecer aquí.' },
    },
    starting: { title: 'Preparándose', words: 'Enseguida se evalúan los intentos.' },
    off: { title: 'Los intentos no se evalúan', words: 'La parte de la caja que los evalúa no está en marcha.' },
    past: 'De antes de perder la conexión',
    onlyNow: (activity) => `Ahora solo cuenta: ${activity}`,
    silence: {
      fine: 'Esta vez, sin correcciones',
      unsure: 'Esta vez, nada claro que corregir',
      unseen: 'No se vio lo bastante bien para evaluarlo',
    },
    rest: 'El resto no se vio lo bastante bien',
    wordless: 'Hay algo que corregir, pero las palabras aún no han llegado',
    score: 'Puntos',
    scoreOf: (value, sigma) => `${value} de 100, más o menos ${sigma}`,
    scoreUnknown: 'Puntos desconocidos',
    next: 'La próxima vez',
    verdicts: { good: 'Bien', fair: 'Casi', poor: 'A trabajar', unknown: 'Desconocido' },
    measure: (value, sigma, unit) => `${value}${unit}, más o menos ${sigma}`,
  },

  attempts: {
    title: 'Intentos',
    none: 'Aquí aparecerán los intentos de esta clase.',
    anew: 'Empezar de nuevo',
    anewTitle: '¿Empezar con una lista vacía?',
    anewWords: 'La lista se vacía en todas las tabletas. No se está grabando nada: estos intentos se perderán.',
    keep: 'Conservar la lista',
    show: (number, action, score, pupil) =>
      `Ver de nuevo el intento ${number}: ${action}${pupil === null ? '' : `, código ${pupil}`}, ${score === null ? 'puntos desconocidos' : `${score} puntos`}`,
  },

  replay: {
    title: 'Cámara lenta',
    loading: 'La repetición está en camino',
    missing: 'La repetición de este intento ya no existe',
    failed: 'La repetición no ha llegado',
    again: 'Otra vez',
    back: 'Volver al directo',
    backThen: 'Volver a la clase',
    play: 'Reproducir',
    pause: 'Pausa',
    position: 'Momento del intento',
    seconds: (at, length) => `${f.number(at, 1)} de ${f.number(length, 1)} segundos`,
    speedLabel: 'Velocidad',
    keyframes: ['Inicio', 'Impulso', 'Clave', 'Fin'],
    keyframeLabel: 'Ir a',
    standard: { ghost: 'Modelo encima', beside: 'Modelo al lado', off: 'Sin modelo' },
    mirror: 'Espejo',
    legend: {
      green: 'Como debe ser',
      yellow: 'Algo desviado',
      red: 'Desviado',
      grey: 'No seguro',
      standard: 'Modelo',
      amiss: 'Desviación',
    },
  },

  cameras: {
    title: 'Cámaras',
    titleThen: 'Cámaras en la clase',
    name: (index) => `Cámara ${index + 1}`,
    states: { ok: 'Bien', slow: 'Lenta', lost: 'Perdida', starting: 'Arrancando', unknown: 'Desconocido' },
    reasons: {
      none: '',
      starting: 'Preparándose',
      unheard: 'Se detuvo la parte de la caja por la que se la oye',
      given_up: 'Se detuvo demasiadas veces; queda apagada hasta reiniciar la caja',
      never_seen: 'Sin noticias desde que se encendió la caja',
      process_gone: 'Su programa se detuvo; la caja lo reinicia',
      silent: 'No da señales de vida',
      failed: 'Avisa de un fallo',
      ended: 'Sus imágenes terminaron; revise el cable y la corriente',
      repeats: 'Envía siempre la misma imagen; desenchúfela y vuelva a enchufarla',
      clock: 'Su reloj va mal; si sigue así, desenchúfela y vuelva a enchufarla',
      no_frames: 'No envía imágenes; revise el cable',
      degraded: 'Funciona peor de lo que debería',
      behind: 'No da abasto',
      backlog: 'Sus imágenes esperan demasiado',
      sparse: 'Pocas imágenes por segundo; puede faltar movimiento rápido',
      resting: 'En reposo; otras cámaras ven mejor',
    },
    none: 'Desconocido sin conexión',
    lost: (lost, left) => {
      const who = lost.length === 1 ? `Cámara ${lost[0]} perdida` : `Cámaras ${listed(lost)} perdidas`;
      if (left >= 2) return `${who} – la clase sigue con ${COUNTS[left] ?? left}`;
      return `${who} – hacen falta dos cámaras para una figura`;
    },
    givenUp: (numbers) =>
      numbers.length === 1
        ? `La cámara ${numbers[0]} no vuelve sola: revísela y reinicie la caja.`
        : `Las cámaras ${listed(numbers)} no vuelven solas: revíselas y reinicie la caja.`,
    busy: 'La caja está ocupada – puede faltar movimiento rápido',
    heldUp: (numbers) =>
      `La caja no da abasto con ${numbers.length === 1 ? 'la cámara' : 'las cámaras'} ${listed(numbers)}`,
    slow: (slow, all) => {
      if (all) return 'Todas las cámaras van lentas – puede faltar movimiento rápido';
      return slow.length === 1 ? `La cámara ${slow[0]} va lenta` : `Las cámaras ${listed(slow)} van lentas`;
    },
    then: {
      lost: (lost) =>
        lost.length === 1 ? `La cámara ${lost[0]} se perdió aquí` : `Las cámaras ${listed(lost)} se perdieron aquí`,
      busy: 'La caja estaba ocupada aquí – puede faltar movimiento rápido',
      heldUp: (numbers) =>
        `La caja no daba abasto aquí con ${numbers.length === 1 ? 'la cámara' : 'las cámaras'} ${listed(numbers)}`,
      slow: (slow, all) => {
        if (all) return 'Todas las cámaras iban lentas aquí – puede faltar movimiento rápido';
        return slow.length === 1
          ? `La cámara ${slow[0]} iba lenta aquí`
          : `Las cámaras ${listed(slow)} iban lentas aquí`;
      },
    },
  },

  troubles: {
    disk_full: 'El disco está lleno – no se pueden grabar clases',
    disk_low: 'El disco está casi lleno',
    memory_low: 'A la caja apenas le queda memoria – puede detenerse',
    hot: 'La caja está demasiado caliente – puede ir lenta',
    throttled: 'La caja está demasiado caliente o le falta corriente – va lenta',
    clock_set: 'Se cambió el reloj de la caja',
  },
  calibration: {
    cameras_exchanged: 'Dos cámaras parecen intercambiadas – la figura puede estar mal',
    cameras_disagree: 'Las cámaras no concuerdan entre sí – la figura puede estar mal',
    camera_moved: 'Se movió o cambió una cámara – la figura puede estar mal',
    remedy: 'En Detalles se dice qué cámaras son y qué hacer.',
  },

  readings: { title: 'Mediciones', rate: 'Figuras por segundo', delay: 'Retraso' },

  details: {
    open: 'Detalles',
    title: 'Para el técnico',
    cameras: 'Cámaras',
    processes: 'Programas de la caja',
    connection: 'Esta tableta',
    box: 'La caja',
    noData: 'Sin conexión con la caja no se sabe nada.',
    legend: [
      ['Nuevas / deseadas', 'imágenes por segundo que se analizaron y que pidió la caja'],
      ['Espera', 'cuánto espera una imagen hasta ser analizada'],
      ['Red neuronal', 'thunder es exacta, lightning es rápida'],
    ],
    columns: {
      camera: 'Cámara',
      fresh: 'Nuevas / deseadas, Hz',
      source: 'Fuente, Hz',
      network: 'Red neuronal',
      backlog: 'Espera, ms',
      skipped: 'Omitidas',
      program: 'Programa',
      state: 'Estado',
      processor: 'Núcleos',
      memory: 'MB',
      restarts: 'Reinicios',
    },
    processStates: {
      ok: 'bien',
      starting: 'arrancando',
      degraded: 'limitado',
      failed: 'fallido',
      silent: 'callado',
      gone: 'ausente',
      unknown: 'desconocido',
    },
    live: 'Figuras por segundo',
    latency: 'Edad de la figura en el servidor, mediana / 95 %',
    delay: 'Edad de la figura en esta pantalla',
    roundTrip: 'Ida y vuelta hasta la caja',
    drawn: 'Figuras dibujadas por segundo',
    dropped: 'Descartadas por tardías',
    unreadable: 'No se pudieron leer',
    processor: 'Procesador en uso',
    temperature: 'Temperatura del procesador',
    memory: 'Memoria libre',
    disk: 'Disco libre',
    clock: 'Fecha y hora de la caja',
    version: 'Versión',
    epoch: 'Película repetida',
    clients: 'Tabletas',
    rejected: 'Rechazados del bus / de tabletas',
  },
};
