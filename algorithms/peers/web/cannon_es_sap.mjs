// cannon-es: SAPBroadphase along x and its intersection test, bounding spheres. It sorts by boxes and stops by spheres, so
// that what is wide hides others.
import {cannon} from './cannon.mjs';

cannon('cannon_es_sap', 'bounding spheres of spheres and boxes', {sap: true});
