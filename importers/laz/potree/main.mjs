// scancast-import-potree FOLDER: reads all points of a Potree octree and writes the point stream to standard output.
// Started by Scancast, once per octree.
import { main } from '../import_main.mjs';
import { importPotree } from './import.mjs';

await main(
  `scancast-import-potree FOLDER > POINTS
Reads a Potree octree (its folder, cloud.js or metadata.json) and writes its points as Scancast's point stream. Scancast
starts it by itself:
  scancast serve lion/metadata.json
`,
  importPotree,
);
