// cannon-es: the contacts of its narrow phase behind its naive broad phase, on the shapes that it has: spheres, boxes,
// capsules as rows of spheres, and meshes, which meet spheres alone: of two meshes, or a mesh and a box, it is silent.
import {cannon} from './cannon.mjs';

cannon('cannon_es_narrow', 'proxies: spheres, boxes, rows of spheres for capsules; else meshes, which meet spheres only',
       {narrow: true});
