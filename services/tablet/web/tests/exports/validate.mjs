// What Khronos' validator says of a glTF file: `node validate.mjs FILE` prints its report as JSON.
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';

const report = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])), { ignoredIssues: [] });
console.log(JSON.stringify(report));
