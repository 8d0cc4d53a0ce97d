// Runs original TensorFlow.js graphs and writes the tensors asked for. Usage: node reference.mjs jobs.json
//
// jobs.json: [{graph, shards, input: {tensor, dtype, shape, file}, outputs: [{tensor, file}]}]; every file of numbers is raw,
// little-endian, int32 or float32.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

// The package lies in the folder that the jobs were started in, not beside this file.
const tf = createRequire(resolve('package.json'))('@tensorflow/tfjs');

function numbers(file, dtype) {
  const bytes = readFileSync(file);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  return dtype === 'int32' ? new Int32Array(buffer) : new Float32Array(buffer);
}

async function load(graph, shards) {
  const document = JSON.parse(readFileSync(graph, 'utf8'));
  const data = Buffer.concat(shards.map((shard) => readFileSync(shard)));
  return tf.loadGraphModel({
    load: async () => ({
      modelTopology: document.modelTopology,
      format: document.format,
      signature: document.signature,
      weightSpecs: document.weightsManifest.flatMap((group) => group.weights),
      weightData: data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength),
    }),
  });
}

await tf.setBackend('cpu');
for (const job of JSON.parse(readFileSync(process.argv[2], 'utf8'))) {
  const model = await load(job.graph, job.shards);
  const { tensor, dtype, shape, file } = job.input;
  const picture = tf.tensor(numbers(file, dtype), shape, dtype);
  const names = job.outputs.map((output) => output.tensor);
  const results = [model.execute({ [tensor]: picture }, names)].flat();
  for (const [index, output] of job.outputs.entries()) {
    writeFileSync(output.file, Buffer.from(new Float32Array(await results[index].data()).buffer));
  }
  console.error(`${job.graph}: ${names.length} tensors`);
}
