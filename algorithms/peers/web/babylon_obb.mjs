// Babylon.js: intersectsMesh, precise: spheres, world boxes, then the separating axes of the oriented boxes.
import {babylon} from './babylon.mjs';

babylon('babylon_obb', 'oriented boxes of the vertices', true);
