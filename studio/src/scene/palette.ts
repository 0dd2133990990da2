// Colors of models and scene. Models have the colors of the printed figures, which are safe for color-blind readers.

export type Theme = 'light' | 'dark';

export const MODEL_COLOURS: Record<Theme, Record<string, string>> = {
  light: { radial: '#1b1b1b', polar: '#e69f00', offset: '#56b4e9', planar: '#cc79a7', approximate: '#787878' },
  dark: { radial: '#f2f2f2', polar: '#e69f00', offset: '#56b4e9', planar: '#d98cb6', approximate: '#9a9a9a' },
};

/** Colors of zones and of the marks of slots. */
export const ZONE_COLORS = { 'keep out': '#c8281c', safe: '#2c9c4b', slot: '#4f8f5f' } as const;

export interface SceneColours {
  background: string;
  ink: string;
  paper: string;
  base: number;
  guide: number;
  motor: number;
  rod: number;
  ball: number;
  race: number;
  section: number;
  platform: number;
  ghost: number;
  grid: number;
  /** Contact of a ball with its bearing. */
  contact: string;
  /** A state to compare with. */
  reference: number;
  handle: number;
  handleActive: number;
  shadow: number;
  /** Actuated joints, virtual joints, and the selection. */
  actuated: number;
  virtual: number;
  selected: number;
  load: number;
  axes: [string, string, string];
  light: number;
}

export const SCENE: Record<Theme, SceneColours> = {
  light: {
    background: '#eef2f6',
    ink: '#1c2733',
    paper: '#ffffff',
    base: 0x7e8893,
    guide: 0xaab3bc,
    motor: 0x59636d,
    rod: 0xd9dfe4,
    ball: 0xe6eaee,
    race: 0x9099a3,
    section: 0xd9694a,
    platform: 0x6f9fd0,
    ghost: 0x6f7b87,
    grid: 0xb4c1ce,
    contact: '#d55e00',
    reference: 0x6f9a5c,
    handle: 0x2a6fb0,
    handleActive: 0xd55e00,
    shadow: 0.55,
    actuated: 0xc44e00,
    virtual: 0xb0479a,
    selected: 0xf0b000,
    load: 0xb3261e,
    axes: ['#b3261e', '#1e7d34', '#1f5fb4'],
    light: 1,
  },
  dark: {
    background: '#141a21',
    ink: '#e6edf3',
    paper: '#0b1016',
    base: 0x66717c,
    guide: 0x97a2ad,
    motor: 0x46505a,
    rod: 0xd0d7dd,
    ball: 0xe0e5ea,
    race: 0x848e98,
    section: 0xd9694a,
    platform: 0x5b8fc4,
    ghost: 0xaab4be,
    grid: 0x384550,
    contact: '#ff9d4d',
    reference: 0x93c27c,
    handle: 0x6db3f2,
    handleActive: 0xff9d4d,
    shadow: 0.85,
    actuated: 0xf08a3c,
    virtual: 0xd98cb6,
    selected: 0xf0b000,
    load: 0xff6b5e,
    axes: ['#ff8a80', '#7ddf92', '#82b8ff'],
    light: 0.85,
  },
};
