// scancast-import-laz [--keep-attributes] FILE: reads a LAZ file (COPC included) and writes the point stream to standard output. Started by
// Scancast, once per file.
import { main } from './import_main.mjs';
import { importLaz } from './laz_import.mjs';

await main(
  `scancast-import-laz [--keep-attributes] FILE > POINTS
Reads a LAZ file and writes its points as Scancast's point stream, with --keep-attributes also GPS time, returns, extra
bytes and whatever else it knows of them. Scancast starts it by itself:
  scancast serve scan.laz
`,
  importLaz,
);
