// bounding_spheres_rust: bounding_spheres.c in Rust, without any crate. The structs are those of plugin.h.
//
//     rustc --edition 2021 --crate-type cdylib -C opt-level=3 -C panic=abort
//         algorithms/plugin/bounding_spheres.rs -o libbounding_spheres_rust.so
//
// No panic may leave a function: with panic=abort it ends the process, and with it this method's answers.
use std::os::raw::{c_char, c_int, c_void};
use std::ptr::null;

const ABI: u32 = 1;
const REAL: u32 = 2;
const CONSERVATIVE: u32 = 1;
const PAIR: u32 = 0;
const ERROR_SIZE: usize = 512;

#[repr(C)]
pub struct Mesh {
    name: *const c_char,
    vertices: *const f64,
    vertex_count: u64,
    triangles: *const u32,
    triangle_count: u64,
    sphere_radius: f64,
    shape: *const c_char,
}

#[repr(C)]
pub struct Bodies {
    body_count: u32,
    mesh_count: u32,
    mesh: *const Mesh,
    name: *const *const c_char,
    body_mesh: *const u32,
    fixed: *const u8,
    chosen: *const u8,
    closed_within: f64,
}

#[repr(C)]
pub struct Pose {
    orientation: [f64; 4],
    position: [f64; 3],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Run {
    a: u32,
    first: u32,
    last: u32,
}

#[repr(C)]
pub struct Pair {
    a: u32,
    b: u32,
}

#[repr(C)]
pub struct Hits {
    pair: *mut Pair,
    size: u64,
    capacity: u64,
    grow: extern "C" fn(*mut Hits, u64) -> c_int,
    owner: *mut c_void,
}

#[repr(C)]
pub struct Value {
    integer: i64,
    real: f64,
    text: *const c_char,
}

#[repr(C)]
pub struct Knob {
    name: *const c_char,
    unit: *const c_char,
    what: *const c_char,
    kind: u32,
    preset: Value,
    least: f64,
    most: f64,
    choices: *const *const c_char,
}

#[repr(C)]
pub struct Row {
    name: *const c_char,
    what: *const c_char,
    unit: *const c_char,
    precision: *const c_char,
    promise: u32,
    scope: u32,
    knobs: *const Knob,
    knob_count: u64,
    create: unsafe extern "C" fn(*const Bodies, *const Value, *mut c_char) -> *mut Method,
    prepare: unsafe extern "C" fn(*mut Method, *const Pose, f64, *mut c_char) -> c_int,
    answer: unsafe extern "C" fn(*mut Method, *const Run, u64, *mut Hits, *mut c_char) -> c_int,
    count: Option<unsafe extern "C" fn(*mut Method, *const Run, u64, *mut Hits, *mut u64, *mut c_char) -> c_int>,
    remember: Option<unsafe extern "C" fn(*mut Method)>,
    forget: Option<unsafe extern "C" fn(*mut Method)>,
    destroy: unsafe extern "C" fn(*mut Method),
}

#[repr(C)]
pub struct Table {
    abi: u32,
    row_count: u32,
    row: *const *const Row,
    version: *const c_char,
}

pub struct Method {
    x: Vec<f64>, // m, at this step
    y: Vec<f64>,
    z: Vec<f64>,
    r: Vec<f64>,
    radius: Vec<f64>, // m, not enlarged
    hit: Vec<u8>,     // of one run, and 8 bytes more
    avx2: bool,
}

const fn text(with_nul: &'static str) -> *const c_char {
    with_nul.as_ptr() as *const c_char
}

unsafe fn fail(error: *mut c_char, why: &str) -> c_int {
    let size = why.len().min(ERROR_SIZE - 1);
    std::ptr::copy_nonoverlapping(why.as_ptr() as *const c_char, error, size);
    *error.add(size) = 0;
    1
}

/// hit[i] for the pairs (a, first + i), by squares; false when one came so close that only the root may decide.
#[inline(always)]
fn overlap_run(x: &[f64], y: &[f64], z: &[f64], r: &[f64], run: Run, hit: &mut [u8]) -> bool {
    let (a, first, last) = (run.a as usize, run.first as usize, run.last as usize);
    let (ax, ay, az, ar, size) = (x[a], y[a], z[a], r[a], last - first);
    let (x, y, z, r) = (&x[first..last], &y[first..last], &z[first..last], &r[first..last]);
    let hit = &mut hit[..size];
    let mut doubt = 0u8;
    for i in 0..size {
        let (dx, dy, dz, reach) = (ax - x[i], ay - y[i], az - z[i], ar + r[i]);
        let (square, reach_square) = (dx * dx + dy * dy + dz * dz, reach * reach);
        hit[i] = (square < reach_square) as u8;
        doubt |= ((square - reach_square).abs() <= reach_square * 8.881784197001252e-16 + 1e-290) as u8; // 2^-50
    }
    doubt == 0
}

/// The same loop, built for AVX2; the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn overlap_run_avx2(x: &[f64], y: &[f64], z: &[f64], r: &[f64], run: Run, hit: &mut [u8]) -> bool {
    overlap_run(x, y, z, r, run, hit)
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx2() -> bool {
    false
}

impl Method {
    /// The definition.
    fn overlap(&self, a: usize, b: usize) -> bool {
        let (dx, dy, dz) = (self.x[a] - self.x[b], self.y[a] - self.y[b], self.z[a] - self.z[b]);
        self.r[a] + self.r[b] > (dx * dx + dy * dy + dz * dz).sqrt()
    }

    fn answer_run(&mut self, run: Run) {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            if !unsafe { overlap_run_avx2(&self.x, &self.y, &self.z, &self.r, run, &mut self.hit) } {
                self.decide_by_root(run);
            }
            return;
        }
        if !overlap_run(&self.x, &self.y, &self.z, &self.r, run, &mut self.hit) {
            self.decide_by_root(run);
        }
    }

    fn decide_by_root(&mut self, run: Run) {
        for b in run.first..run.last {
            let met = self.overlap(run.a as usize, b as usize);
            self.hit[(b - run.first) as usize] = met as u8;
        }
    }
}

/// False when there is no memory left.
unsafe fn report(hits: &mut Hits, a: u32, b: u32) -> bool {
    if hits.size == hits.capacity && (hits.grow)(hits, 1) != 0 {
        return false;
    }
    *hits.pair.add(hits.size as usize) = Pair { a, b };
    hits.size += 1;
    true
}

unsafe extern "C" fn create(bodies: *const Bodies, knobs: *const Value, _error: *mut c_char) -> *mut Method {
    let (bodies, scale) = (&*bodies, (*knobs).real);
    let mut radius = Vec::new();
    for body in 0..bodies.body_count as usize {
        let mesh = &*bodies.mesh.add(*bodies.body_mesh.add(body) as usize);
        let mut half = [0f64; 3];
        for i in 0..3 * mesh.vertex_count as usize {
            half[i % 3] = half[i % 3].max((*mesh.vertices.add(i)).abs());
        }
        radius.push(scale * (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt());
    }
    let (x, y, z, r, hit) = (radius.clone(), radius.clone(), radius.clone(), radius.clone(), vec![0; radius.len() + 8]);
    Box::into_raw(Box::new(Method { x, y, z, r, radius, hit, avx2: has_avx2() }))
}

unsafe extern "C" fn prepare(method: *mut Method, poses: *const Pose, enlarge: f64, _error: *mut c_char) -> c_int {
    let method = &mut *method;
    for body in 0..method.radius.len() {
        let t = &(*poses.add(body)).position;
        method.x[body] = t[0];
        method.y[body] = t[1];
        method.z[body] = t[2];
        method.r[body] = method.radius[body];
        if enlarge > 0.0 {
            let far = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
            method.r[body] += enlarge * (method.radius[body] + far);
        }
    }
    0
}

unsafe extern "C" fn answer(
    method: *mut Method,
    runs: *const Run,
    run_count: u64,
    hits: *mut Hits,
    error: *mut c_char,
) -> c_int {
    let (method, hits) = (&mut *method, &mut *hits);
    for i in 0..run_count as usize {
        let run = *runs.add(i);
        let size = (run.last - run.first) as usize;
        method.answer_run(run);
        method.hit[size..size + 8].fill(0);
        // Hits are rare: eight answers are skipped at once.
        for (block, eight) in method.hit[..size + 7].chunks_exact(8).enumerate() {
            if u64::from_ne_bytes(eight.try_into().unwrap()) == 0 {
                continue;
            }
            for (k, &met) in eight.iter().enumerate() {
                if met != 0 && !report(hits, run.a, run.first + (8 * block + k) as u32) {
                    return fail(error, "out of memory");
                }
            }
        }
    }
    0
}

unsafe extern "C" fn count(
    method: *mut Method,
    runs: *const Run,
    run_count: u64,
    hits: *mut Hits,
    operations: *mut u64,
    error: *mut c_char,
) -> c_int {
    let (method, hits) = (&*method, &mut *hits);
    for i in 0..run_count as usize {
        let run = *runs.add(i);
        for b in run.first..run.last {
            *operations += 1;
            if method.overlap(run.a as usize, b as usize) && !report(hits, run.a, b) {
                return fail(error, "out of memory");
            }
        }
    }
    0
}

unsafe extern "C" fn destroy(method: *mut Method) {
    drop(Box::from_raw(method));
}

/// What never changes, so that threads do not matter.
struct Shared<T>(T);
unsafe impl<T> Sync for Shared<T> {}

static KNOB: Shared<Knob> = Shared(Knob {
    name: text("scale\0"),
    unit: text("1\0"),
    what: text("balls are so many times as large\0"),
    kind: REAL,
    preset: Value { integer: 0, real: 1.0, text: null() },
    least: 1.0,
    most: 1000.0,
    choices: null(),
});

static ROW: Shared<Row> = Shared(Row {
    name: text("bounding_spheres_rust\0"),
    what: text("balls of the half diagonal about the bodies' positions overlap\0"),
    unit: text("distances\0"),
    precision: text("double\0"),
    promise: CONSERVATIVE,
    scope: PAIR,
    knobs: &KNOB.0,
    knob_count: 1,
    create,
    prepare,
    answer,
    count: Some(count),
    remember: None,
    forget: None,
    destroy,
});

static ROWS: Shared<[*const Row; 1]> = Shared([&ROW.0]);
static TABLE: Shared<Table> = Shared(Table { abi: ABI, row_count: 1, row: ROWS.0.as_ptr(), version: text("1\0") });

#[no_mangle]
pub extern "C" fn collision_plugin() -> *const Table {
    &TABLE.0
}
