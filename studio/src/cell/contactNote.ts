// Stations taught by a pose in contact.

/** A contact in the pose by which a station is taught. */
export interface ContactRequest {
  station: string;
  /** What touches. */
  message: string;
  /** Text of the cell and pose of the robot that were checked [m or rad]. */
  cell: string;
  positions: number[];
  /** Teaches the station in contact. */
  confirm: () => void;
}

/** The field of a request that confirms a contact. */
export const CONTACT_FIELD = 'taught_by.confirm_contact';
/** How the note of a station begins that was taught in contact. */
const NOTE = '# Taught in contact: ';

/** The line of a station's note that it was taught in contact, from 1. */
export function contactNoteLine(text: string, station: string): number {
  const lines = text.split('\n');
  const named = lines.findIndex((line) => /^\s*(\{\s*)?name\s*=/.test(line) && (line.includes(`"${station}"`) || line.includes(`'${station}'`)));
  const notes = lines.flatMap((line, k) => (line.trimStart().startsWith(NOTE) ? [k] : []));
  return (notes.filter((k) => k <= named).at(-1) ?? notes[0] ?? 0) + 1;
}
