// Size and content of exported pictures, remembered by the browser.

import { SCREEN_DPI, onPaper, pictureSizeProblem, type PictureSize } from '../lib/png';
import { load, save } from '../lib/settings';

export const PICTURE_SIZES = {
  view: 'As the view, twice its pixels',
  slide: '1920 × 1080 pixels',
  column: '85 mm wide, 600 dpi',
  page: '170 mm wide, 300 dpi',
  other: 'Other size',
} as const;
export type PictureSizeName = keyof typeof PICTURE_SIZES;

/** Size of texts on paper against that on the screen, where a pixel is 1/96 inch. */
const TEXT = 0.75;

interface Settings {
  size: PictureSizeName;
  other: PictureSize;
  transparent: boolean;
  labels: boolean;
}

const INITIAL: Settings = { size: 'view', other: { width: 2400, height: 1600, dpi: 300 }, transparent: false, labels: true };
function isSettings(value: unknown): boolean {
  const { size, other, transparent, labels } = (value ?? {}) as Partial<Settings>;
  const known = typeof size === 'string' && Object.hasOwn(PICTURE_SIZES, size);
  return known && typeof other === 'object' && other !== null && pictureSizeProblem(other) === null && typeof transparent === 'boolean' && typeof labels === 'boolean';
}

class PictureSettings {
  value = $state<Settings>(load('picture', INITIAL, isSettings));

  /** Why there is no picture of the chosen size; `null` if there is one. */
  get problem(): string | null {
    return this.value.size === 'other' ? pictureSizeProblem(this.value.other) : null;
  }

  /** Remembers valid settings. */
  save(): void {
    if (this.problem === null) save('picture', $state.snapshot(this.value));
  }

  /** Size of a picture of a view, and its pixels per pixel of texts on the screen. */
  of(view: { width: number; height: number }): PictureSize & { scale: number } {
    if (this.problem !== null) throw new Error(this.problem);
    const aspect = view.width / view.height;
    const onPaperScale = (size: PictureSize) => ({ ...size, scale: (TEXT * size.dpi) / SCREEN_DPI });
    switch (this.value.size) {
      case 'view':
        return { width: Math.round(2 * view.width), height: Math.round(2 * view.height), dpi: 2 * SCREEN_DPI, scale: 2 };
      case 'slide':
        return { width: 1920, height: 1080, dpi: 2 * SCREEN_DPI, scale: 1.5 };
      case 'column':
        return onPaperScale(onPaper(85, aspect, 600));
      case 'page':
        return onPaperScale(onPaper(170, aspect, 300));
      default:
        return onPaperScale({ ...this.value.other });
    }
  }
}

export const pictureSettings = new PictureSettings();
