// The method of algorithms/program/conversation.txt: centres nearer than the knob `reach`; fails at step 9.
import {serve} from '../../algorithms/program/collision_program.mjs';

function setup(run) {
  console.log('a banner that must not reach stdout');
  process.stdout.write('nor this one\n');
  const answer = step => {
    if (step.number === 9) throw new Error('no step 9');
    return [...step.pairs()].filter(([a, b]) => {
      const p = step.position(a), q = step.position(b);
      return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2 < run.knobs.reach ** 2;
    });
  };
  const count = step => [[...step.pairs()].length, answer(step)];
  return {answer, count, remember() {}, forget() {}};
}

serve(setup, {name: 'near', version: '1.0', promise: 'none', operations_unit: 'distances', memory_bytes: 48});
