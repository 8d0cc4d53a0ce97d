import type { Words } from './en';
import { formats } from './format';

const listed = (numbers: number[]): string => numbers.join('、');

const phases: Words['phases'] = {
  connecting: { pill: '连接中', title: '正在连接主机', words: '请稍候。' },
  offline: { pill: '无连接', title: '与主机没有连接', words: '正在重试。主机是否已开机，平板是否在它的网络中？' },
  failed: { pill: '故障', title: '主机不再生成人形', words: '其中一个部分停止次数过多，已被关闭。请重新启动主机。' },
  searching: { pill: '等待', title: '正在寻找学生', words: '两台摄像机看到学生后，人形就会出现。' },
  waiting: { pill: '等待', title: '画面中没有人', words: '学生站到两台摄像机都能看到的位置后，人形就会出现。' },
  stale: { pill: '中断', title: '没有新的动作', words: '灰色人形是最后看到的样子。' },
  late: { pill: '太慢', title: '画面到得太晚', words: '主机、这台平板或网络跟不上。' },
  unable: {
    pill: '无画面',
    title: '这台平板无法显示三维画面',
    words: '它的浏览器没有 WebGL 2。请更新浏览器，或换一台平板。',
  },
  live: { pill: '实时', title: '', words: '' },
};

const f = formats('zh-CN');

export const zh: Words = {
  formats: f,
  product: 'KineBox',
  language: '语言',
  side: '反馈与现场状态',
  phases,
  gettingReady: { title: '摄像机正在准备', words: '请稍候。' },
  late: {
    box: { title: '主机繁忙', words: '任务太多，画面到得太晚，无法显示。' },
    tablet: { title: '这台平板繁忙', words: '任务太多，无法及时显示画面。请关闭其他程序。' },
    network: { title: phases.late.title, words: '主机和平板都跟得上，网络可能跟不上。请靠近无线接入点。' },
    unknown: phases.late,
  },
  staleFor: (s) => (s ? `已有 ${s} 秒没有新的动作` : phases.stale.title),

  lesson: {
    recording: '录制中',
    replay: (title, beganMs) => ['回放', title, f.day(beganMs)].filter(Boolean).join(' · '),
  },

  view: {
    label: '学生的三维人形',
    help: '用方向键转动视角，用加号和减号拉近、拉远，按 R 键回到最初视角。空格键暂停或继续回放，Esc 键结束回放。',
    reset: '重置视角',
    measured: '看到',
    unsure: '不确定',
  },

  activity: {
    title: '项目',
    choose: '选择项目',
    close: '关闭',
    any: '任意项目',
    anyHint: '由主机自动识别',
    unknown: '未知',
  },

  feedback: {
    title: '最近一次',
    earlier: (number) => `第 ${number} 次`,
    none: { title: '还没有动作', words: '每次动作结束一秒后，这里会说明要改进什么。' },
    off: { title: '没有在评价动作', words: '主机中负责评价的部分没有运行。' },
    past: '连接中断之前的内容',
    fine: '这次没有要纠正的',
    unseen: '看得不够清楚，无法评价',
    score: '得分',
    scoreOf: (value, sigma) => `满分 100，得 ${value}，上下 ${sigma}`,
    scoreUnknown: '得分未知',
    next: '下一次',
    verdicts: { good: '好', fair: '接近', poor: '要练习', unknown: '未知' },
    measure: (value, sigma, unit) => `${value}${unit}，上下 ${sigma}`,
  },

  attempts: {
    title: '各次动作',
    none: '这节课的各次动作会列在这里。',
    show: (number, action, score) => `再看第 ${number} 次：${action}，${score === null ? '得分未知' : `${score} 分`}`,
  },

  replay: {
    title: '慢动作回放',
    loading: '回放即将开始',
    missing: '这次动作的回放已不存在',
    back: '回到实时',
    play: '播放',
    pause: '暂停',
    position: '动作中的时刻',
    seconds: (at, length) => `${f.number(at, 1)} 秒，共 ${f.number(length, 1)} 秒`,
    speedLabel: '速度',
    keyframes: ['开始', '发力', '关键', '结束'],
    keyframeLabel: '跳到',
    standard: { ghost: '示范重叠', beside: '示范并排', off: '不显示示范' },
    mirror: '镜像',
    legend: { green: '符合要求', yellow: '略有偏差', red: '偏差大', grey: '不确定', standard: '示范' },
  },

  cameras: {
    title: '摄像机',
    titleThen: '当时的摄像机',
    name: (index) => `摄像机 ${index + 1}`,
    states: { ok: '正常', slow: '慢', lost: '丢失', starting: '启动中', unknown: '未知' },
    reasons: {
      none: '',
      starting: '正在准备',
      unheard: '主机中转达它消息的部分停止了',
      given_up: '停止次数过多；重新启动主机之前不再使用',
      never_seen: '主机启动后一直没有消息',
      process_gone: '它的程序停止了；主机正在重新启动它',
      silent: '没有任何响应',
      failed: '报告了故障',
      ended: '画面中止；请检查电缆和电源',
      repeats: '反复发送同一画面；请拔下再插上',
      clock: '它的时钟不准；如果一直如此，请拔下再插上',
      no_frames: '没有发送画面；请检查电缆',
      degraded: '工作不如预期',
      behind: '跟不上',
      backlog: '画面等待太久',
      sparse: '每秒画面太少；可能漏掉快速动作',
      resting: '休息中；其他摄像机看得更清楚',
    },
    none: '没有连接，无法得知',
    lost: (lost, left) => {
      const who = `摄像机 ${listed(lost)} 丢失`;
      return left >= 2 ? `${who} – 用 ${left} 台继续上课` : `${who} – 需要两台摄像机才能生成人形`;
    },
    givenUp: (numbers) => `摄像机 ${listed(numbers)} 不会自行恢复：请检查，然后重新启动主机。`,
    busy: '主机繁忙 – 可能漏掉快速动作',
    slow: (slow, all) => (all ? '所有摄像机都慢 – 可能漏掉快速动作' : `摄像机 ${listed(slow)} 较慢`),
    then: {
      lost: (lost) => `摄像机 ${listed(lost)} 当时丢失`,
      busy: '当时主机繁忙 – 可能缺少快速动作',
      slow: (slow, all) => (all ? '当时所有摄像机都慢 – 可能缺少快速动作' : `摄像机 ${listed(slow)} 当时较慢`),
    },
  },

  troubles: {
    disk_full: '磁盘已满 – 无法录制课程',
    disk_low: '磁盘快满了',
    memory_low: '主机内存几乎用尽 – 可能停止',
    hot: '主机过热 – 可能变慢',
    throttled: '主机过热或供电不足 – 运行缓慢',
    clock_set: '主机的时钟被调整过',
  },
  calibration: {
    cameras_exchanged: '两台摄像机似乎接反了 – 人形可能不准',
    cameras_disagree: '摄像机之间不一致 – 人形可能不准',
    camera_moved: '有摄像机被移动或更换 – 人形可能不准',
    remedy: '“详情”中说明是哪些摄像机以及怎么办。',
  },

  readings: { title: '读数', rate: '每秒人形数', delay: '延迟' },

  details: {
    open: '详情',
    title: '技术人员信息',
    close: '关闭',
    cameras: '摄像机',
    processes: '主机的程序',
    connection: '这台平板',
    box: '主机',
    noData: '与主机没有连接，一切未知。',
    legend: [
      ['新画面 / 期望', '每秒分析的画面数，以及主机要求的画面数'],
      ['等待', '画面被分析之前等待的时间'],
      ['网络', 'thunder 精确，lightning 快速'],
    ],
    columns: {
      camera: '摄像机',
      fresh: '新画面 / 期望，Hz',
      source: '来源，Hz',
      network: '网络',
      backlog: '等待，ms',
      skipped: '跳过',
      program: '程序',
      state: '状态',
      processor: '核心',
      memory: 'MB',
      restarts: '重启',
    },
    processStates: {
      ok: '正常',
      starting: '启动中',
      degraded: '受限',
      failed: '故障',
      silent: '无响应',
      gone: '已退出',
      unknown: '未知',
    },
    live: '每秒人形数',
    latency: '人形到达服务器时的时延，中位数 / 95 %',
    delay: '屏幕上人形的时延',
    roundTrip: '到主机的往返时间',
    drawn: '每秒绘制的人形数',
    dropped: '因太晚而丢弃',
    unreadable: '无法读取',
    processor: '处理器占用',
    temperature: '处理器温度',
    memory: '空闲内存',
    disk: '空闲磁盘',
    clock: '主机的日期和时间',
    version: '版本',
    epoch: '影片重复次数',
    clients: '平板数',
    rejected: '拒收：总线 / 平板',
  },
};
