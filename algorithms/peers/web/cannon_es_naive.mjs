// cannon-es: NaiveBroadphase, all pairs, and its intersection test, bounding spheres.
import {cannon} from './cannon.mjs';

cannon('cannon_es_naive', 'bounding spheres of spheres and boxes');
