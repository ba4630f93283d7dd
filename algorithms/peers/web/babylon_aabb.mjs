// Babylon.js: intersectsMesh, not precise: world boxes of the turned boxes.
import {babylon} from './babylon.mjs';

babylon('babylon_aabb', 'world boxes of the turned boxes', false);
