// Stations taught in a pose with contact.

/** Request to confirm that a station is taught in contact. */
export interface ContactRequest {
  station: string;
  /** Description of the contact. */
  message: string;
  /** Text of the cell and positions of the axes that were checked [m or rad]. */
  cell: string;
  positions: number[];
  /** Teaches the station. */
  confirm: () => void;
}

/** Field of the request that confirms a contact. */
export const CONTACT_FIELD = 'taught_by.confirm_contact';
/** Start of the comment at a station that was taught in contact. */
const NOTE = '# Taught in contact: ';

/** Line number of the comment at a station that was taught in contact. */
export function contactNoteLine(text: string, station: string): number {
  const lines = text.split('\n');
  const named = lines.findIndex((line) => /^\s*(\{\s*)?name\s*=/.test(line) && (line.includes(`"${station}"`) || line.includes(`'${station}'`)));
  const notes = lines.flatMap((line, k) => (line.trimStart().startsWith(NOTE) ? [k] : []));
  return (notes.filter((k) => k <= named).at(-1) ?? notes[0] ?? 0) + 1;
}
