// Size and content of exported pictures, remembered by the browser.

import { SCREEN_DPI, onPaper, type PictureSize } from '../lib/png';
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
const isNumber = (value: unknown): value is number => typeof value === 'number' && Number.isFinite(value) && value > 0;
function isSettings(value: unknown): boolean {
  const { size, other, transparent, labels } = (value ?? {}) as Partial<Settings>;
  return size !== undefined && size in PICTURE_SIZES && isNumber(other?.width) && isNumber(other?.height) && isNumber(other?.dpi) && typeof transparent === 'boolean' && typeof labels === 'boolean';
}

class PictureSettings {
  value = $state<Settings>(load('picture', INITIAL, isSettings));

  save(): void {
    save('picture', $state.snapshot(this.value));
  }

  /** Size of a picture of a view, and its pixels per pixel of texts on the screen. */
  of(view: { width: number; height: number }): PictureSize & { scale: number } {
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
        return onPaperScale({ width: Math.round(this.value.other.width), height: Math.round(this.value.other.height), dpi: this.value.other.dpi });
    }
  }
}

export const pictureSettings = new PictureSettings();
