// A method of your own in JavaScript, asked by `pipeline` on stdin and stdout: algorithms/README.md, "A program".
//
//   import {serve} from './collision_program.mjs';
//
//   function setup(run) {  // once. run: label, bodies (name, mesh, fixed), meshes (name, vertices, triangles), knobs
//     return step =>       // timed. The pairs [a, b], a < b, that meet
//       [...step.pairs()].filter(([a, b]) => near(step.position(a), step.position(b)));
//   }
//   serve(setup, {name: 'mine'});
//
// What is printed by `console` goes to stderr: stdout belongs to the frames.
import {readSync, writeSync} from 'node:fs';

class Step {
  constructor(content, bodies) {  // poses: px py pz qw qx qy qz of every body (NaN: not there yet); runs: a first last
    this.number = content.readUInt32LE(0);
    this.enlarge = content.readDoubleLE(8);
    const bytes = content.buffer.slice(content.byteOffset, content.byteOffset + content.length);
    this.poses = new Float64Array(bytes, 16, 7 * bodies);
    this.runs = new Uint32Array(bytes, 16 + 56 * bodies, 3 * content.readUInt32LE(4));
  }
  position(body) { return this.poses.subarray(7 * body, 7 * body + 3); }          // m
  orientation(body) { return this.poses.subarray(7 * body + 3, 7 * body + 7); }  // unit quaternion w x y z
  * pairs() {
    for (let i = 0; i < this.runs.length; i += 3)
      for (let b = this.runs[i + 1]; b < this.runs[i + 2]; ++b) yield [this.runs[i], b];
  }
}

function read(size) {  // null at the end
  const bytes = Buffer.alloc(size);
  for (let at = 0, got; at < size; at += got) if (!(got = readSync(0, bytes, at, size - at))) return null;
  return bytes;
}

function send(kind, number, content = Buffer.alloc(0)) {
  const bytes = Buffer.concat([Buffer.from(kind), Buffer.alloc(8), content]);
  bytes.writeUInt32LE(content.length, bytes.writeUInt32LE(number, 4));
  for (let at = 0; at < bytes.length;) at += writeSync(1, bytes, at);
}

function hits(pairs, time = 0, prepare = 0, operations = 0) {
  const bytes = Buffer.alloc(24 + 8 * pairs.length);
  [time, prepare, operations].forEach((value, i) => bytes.writeDoubleLE(value, 8 * i));
  pairs.forEach(([a, b], i) => bytes.writeUInt32LE(b, bytes.writeUInt32LE(a, 24 + 8 * i)));
  return bytes;
}

export async function serve(setup, about) {
  for (const said of ['log', 'info', 'debug']) console[said] = console.error;
  process.stdout.write = process.stderr.write.bind(process.stderr);
  const now = () => Number(process.hrtime.bigint());  // ns; exact for 104 days
  let method = {}, bodies = 0, number = 0;
  try {
    for (let head; (head = read(12));) {
      const kind = head.toString('latin1', 0, 4), content = read(head.readUInt32LE(8));
      number = head.readUInt32LE(4);
      if (kind === 'HELO') {
        const run = JSON.parse(content), begin = now(), made = await setup(run), setup_ns = now() - begin;
        bodies = run.bodies.length;
        method = typeof made === 'function' ? {answer: made} : made;
        const said = {protocol: 1, language: 'JavaScript, node ' + process.versions.node, setup_ns};
        Object.assign(said, {remembers: 'remember' in method}, method.about, about);
        send('HELO', number, Buffer.from(JSON.stringify(said)));
      } else if (kind === 'STEP' || kind === 'OPER') {
        const step = new Step(content, bodies), begin = now();
        method.prepare?.(step);
        const prepared = method.prepare ? now() - begin : 0;
        const [operations, pairs] = kind === 'OPER' ? method.count(step) : [0, method.answer(step)];
        const time = now() - begin;
        send('HITS', number, kind === 'OPER' ? hits(pairs, 0, 0, operations) : hits(pairs, time, prepared));
      } else {
        method[kind === 'KEEP' ? 'remember' : 'forget']();
        send('DONE', number);
      }
    }
  } catch (error) {
    send('FAIL', number, Buffer.from(String(error?.stack ?? error).split('\n').slice(0, 2).join(' ')).subarray(0, 65536));
  }
}
