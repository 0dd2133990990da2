// A picture of a view for export.

export interface Picture {
  /** Pixels. */
  width: number;
  height: number;
  /** Pixels of the picture per pixel of texts on the screen. */
  scale: number;
  transparent: boolean;
  labels: boolean;
  /** Text at the lower left. */
  note: string;
}
