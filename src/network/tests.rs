//! Tests operators against their definitions, and files that are damaged, inconsistent, or demand too much memory.
//! `tests/python/test_network.py` compares whole networks with another runtime.

use super::writer::Setting::{F, I, Is, S, T};
use super::writer::Writer;
use super::*;
use crate::error::{Error, ErrorKind, Result};
use crate::exec::Pool;
use crate::job::Monitor;
use crate::rng::Rng;

fn noise(seed: u64, shape: &[usize]) -> Tensor {
    let mut rng = Rng::new(seed, &[]);
    Tensor::floats(shape.to_vec(), (0..shape.iter().product()).map(|_| rng.next_f32() - 0.5).collect())
}

fn run(file: &[u8], input: &Tensor) -> Result<Tensor> {
    Network::parse(file)?.run(input.clone(), Monitor::default().job())
}

/// Runs a network of a single node on `x`. `more` are the node's further inputs, which are constants.
fn node(kind: &str, x: &Tensor, more: &[(&str, &Tensor)], settings: &[super::writer::Setting]) -> Tensor {
    let shape: Vec<i64> = x.shape.iter().map(|&n| n as i64).collect();
    let mut writer = Writer::new(17, &shape);
    let mut names = vec!["x"];
    for (name, tensor) in more {
        writer = writer.constant(name, tensor);
        names.push(name);
    }
    run(&writer.node(kind, &names, "y", settings).file(), x).unwrap()
}

fn close(got: &Tensor, shape: &[usize], expected: impl Fn(usize) -> f64) {
    assert_eq!(got.shape, shape);
    for (i, v) in got.as_floats().unwrap().iter().enumerate() {
        assert!((f64::from(*v) - expected(i)).abs() < 1e-5, "{i}: {v} {}", expected(i));
    }
}

#[test]
fn convolutions_are_their_definition() {
    for (groups, channels, out, stride, dilation, pad) in
        [(1, 3, 5, 1, 1, 1), (1, 4, 8, 2, 1, 1), (6, 6, 6, 1, 1, 1), (2, 4, 6, 2, 2, 3), (3, 3, 6, 3, 1, 0)]
    {
        let (height, width, kernel) = (13, 37, 3);
        let x = noise(1, &[2, channels, height, width]);
        let weights = noise(2, &[out, channels / groups, kernel, kernel]);
        let bias = noise(3, &[out]);
        let got = node(
            "Conv",
            &x,
            &[("w", &weights), ("b", &bias)],
            &[
                I("group", groups as i64),
                Is("strides", &[stride as i64; 2]),
                Is("dilations", &[dilation as i64; 2]),
                Is("pads", &[pad as i64; 4]),
            ],
        );
        let size = |n: usize| (n + 2 * pad - dilation * (kernel - 1) - 1) / stride + 1;
        let (rows, columns) = (size(height), size(width));
        let (x, w, b) = (x.as_floats().unwrap(), weights.as_floats().unwrap(), bias.as_floats().unwrap());
        close(&got, &[2, out, rows, columns], |i| {
            let (image, o, y, c) =
                (i / columns / rows / out, i / columns / rows % out, i / columns % rows, i % columns);
            let per_group = channels / groups;
            let mut sum = f64::from(b[o]);
            for k in 0..per_group {
                for (u, v) in (0..kernel * kernel).map(|t| (t / kernel, t % kernel)) {
                    let (row, column) = (y * stride + u * dilation, c * stride + v * dilation);
                    if (pad..height + pad).contains(&row) && (pad..width + pad).contains(&column) {
                        let plane = image * channels + o / (out / groups) * per_group + k;
                        let pixel = x[(plane * height + row - pad) * width + column - pad];
                        sum += f64::from(pixel) * f64::from(w[((o * per_group + k) * kernel + u) * kernel + v]);
                    }
                }
            }
            sum
        });
    }
}

#[test]
fn a_transposed_convolution_is_the_adjoint_of_the_convolution() {
    let settings = || [Is("strides", &[2, 2]), Is("pads", &[1, 0, 1, 0]), Is("kernel_shape", &[3, 2])];
    let (x, weights) = (noise(1, &[1, 3, 9, 10]), noise(2, &[4, 3, 3, 2]));
    let image = node("Conv", &x, &[("w", &weights)], &settings());
    let y = noise(3, &image.shape);
    let back = node("ConvTranspose", &y, &[("w", &weights)], &settings());
    assert_eq!(back.shape, x.shape);
    let dot = |a: &Tensor, b: &Tensor| -> f64 {
        a.as_floats().unwrap().iter().zip(b.as_floats().unwrap()).map(|(a, b)| f64::from(a * b)).sum()
    };
    assert!((dot(&image, &y) - dot(&x, &back)).abs() < 1e-4);
}

#[test]
fn products_of_stacks_of_matrices() {
    for (a, b, out) in [
        (vec![5, 7], vec![7, 19], vec![5, 19]),
        (vec![2, 3, 6, 300], vec![300, 33], vec![2, 3, 6, 33]),
        (vec![2, 1, 9, 4], vec![3, 4, 5], vec![2, 3, 9, 5]),
        (vec![4], vec![4, 3], vec![3]),
        (vec![2, 5, 4], vec![4], vec![2, 5]),
    ] {
        let (x, w) = (noise(1, &a), noise(2, &b));
        let got = node("MatMul", &x, &[("w", &w)], &[]);
        let shared = b[b.len().saturating_sub(2)];
        let columns = if b.len() == 1 { 1 } else { b[b.len() - 1] };
        let rows = if a.len() == 1 { 1 } else { a[a.len() - 2] };
        let (x, w) = (x.as_floats().unwrap(), w.as_floats().unwrap());
        close(&got, &out, |i| {
            let (matrix, row, column) = (i / columns / rows, i / columns % rows, i % columns);
            // Broadcast the stacks of matrices: the matrices of `a` repeat along its axis of size 1, the matrices of
            // `b` along the outermost axis.
            let (m, n) = match a.len() {
                4 if a[1] == 1 => (matrix / 3, matrix % 3),
                _ => (matrix, 0),
            };
            let item = |k: usize| {
                f64::from(x[(m * rows + row) * shared + k]) * f64::from(w[(n * shared + k) * columns + column])
            };
            (0..shared).map(item).sum()
        });
    }
    let (x, w, c) = (noise(1, &[3, 4]), noise(2, &[5, 3]), noise(3, &[5]));
    let got =
        node("Gemm", &x, &[("w", &w), ("c", &c)], &[I("transA", 1), I("transB", 1), F("alpha", 2.0), F("beta", 0.5)]);
    let (x, w, c) = (x.as_floats().unwrap(), w.as_floats().unwrap(), c.as_floats().unwrap());
    close(&got, &[4, 5], |i| {
        let (row, column) = (i / 5, i % 5);
        let sum: f64 = (0..3).map(|k| f64::from(x[k * 4 + row] * w[column * 3 + k])).sum();
        2.0 * sum + 0.5 * f64::from(c[column])
    });
}

#[test]
fn element_wise_operators_broadcast_as_in_numpy() {
    let x = noise(1, &[2, 3, 4]);
    let values = x.as_floats().unwrap().to_vec();
    for (shape, at) in
        [(vec![3, 1], (|i: usize| i / 4 % 3) as fn(usize) -> usize), (vec![4], |i| i % 4), (vec![2, 1, 1], |i| i / 12)]
    {
        let w = noise(2, &shape);
        let factors = w.as_floats().unwrap().to_vec();
        close(&node("Mul", &x, &[("w", &w)], &[]), &[2, 3, 4], |i| f64::from(values[i]) * f64::from(factors[at(i)]));
    }
    for (kind, of) in [
        ("Relu", (|v: f64| v.max(0.0)) as fn(f64) -> f64),
        ("Sigmoid", |v| 1.0 / (1.0 + (-v).exp())),
        ("HardSwish", |v| v * ((v + 3.0) / 6.0).clamp(0.0, 1.0)),
        ("Softplus", |v| v.exp().ln_1p()),
        // The error function by its power series.
        ("Erf", |v| {
            let terms = (0..12).map(|n| {
                let n = f64::from(n);
                let factorial: f64 = (1..=n as i32).map(f64::from).product();
                (-1.0f64).powf(n) * v * (v * v).powf(n) / (factorial * (2.0 * n + 1.0))
            });
            2.0 / std::f64::consts::PI.sqrt() * terms.sum::<f64>()
        }),
    ] {
        close(&node(kind, &x, &[], &[]), &[2, 3, 4], |i| of(f64::from(values[i])));
    }
    let got = node("Softmax", &x, &[], &[I("axis", 1)]);
    let sums: Vec<f32> =
        (0..8).map(|i| (0..3).map(|k| got.as_floats().unwrap()[i / 4 * 12 + k * 4 + i % 4]).sum()).collect();
    assert!(sums.iter().all(|s| (s - 1.0).abs() < 1e-6), "{sums:?}");
    let one = Tensor::floats(vec![4], vec![1.0; 4]);
    let got = node("LayerNormalization", &x, &[("w", &one)], &[]);
    for row in got.as_floats().unwrap().chunks_exact(4) {
        assert!(row.iter().sum::<f32>().abs() < 1e-5 && (row.iter().map(|v| v * v).sum::<f32>() - 4.0).abs() < 0.01);
    }
}

fn expect(got: &Tensor, shape: &[usize], values: &[f32]) {
    assert_eq!((got.shape.as_slice(), got.as_floats().unwrap()), (shape, values));
}

#[test]
fn items_are_rearranged_broadcast_padded_and_reduced() {
    let x = Tensor::floats(vec![2, 3], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    let ints = |values: &[i64]| Tensor::integers(vec![values.len()], values.to_vec());
    expect(&node("Transpose", &x, &[], &[]), &[3, 2], &[0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
    expect(
        &node(
            "Slice",
            &x,
            &[("s", &ints(&[-1, 0])), ("e", &ints(&[-9, 9])), ("a", &ints(&[1, 0])), ("t", &ints(&[-2, 1]))],
            &[],
        ),
        &[2, 2],
        &[2.0, 0.0, 5.0, 3.0],
    );
    expect(&node("Gather", &x, &[("i", &ints(&[-1, 0]))], &[I("axis", 1)]), &[2, 2], &[2.0, 0.0, 5.0, 3.0]);
    expect(
        &node("Expand", &x, &[("s", &ints(&[2, 1, 3]))], &[]),
        &[2, 2, 3],
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0].repeat(2),
    );
    expect(
        &node("Tile", &x, &[("r", &ints(&[1, 2]))], &[]),
        &[2, 6],
        &[0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 3.0, 4.0, 5.0],
    );
    let pads = ints(&[0, 2, 0, 1]);
    expect(
        &node("Pad", &x, &[("p", &pads)], &[S("mode", "reflect")]),
        &[2, 6],
        &[2.0, 1.0, 0.0, 1.0, 2.0, 1.0, 5.0, 4.0, 3.0, 4.0, 5.0, 4.0],
    );
    expect(
        &node("Pad", &x, &[("p", &pads)], &[S("mode", "edge")]),
        &[2, 6],
        &[0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 4.0, 5.0, 5.0],
    );
    expect(
        &node("Concat", &x, &[("w", &x)], &[I("axis", 1)]),
        &[2, 6],
        &[0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 3.0, 4.0, 5.0],
    );
    expect(&node("Reshape", &x, &[("s", &ints(&[0, -1, 1]))], &[]), &[2, 3, 1], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    expect(&node("ReduceMean", &x, &[], &[Is("axes", &[0]), I("keepdims", 0)]), &[3], &[1.5, 2.5, 3.5]);
    expect(&node("ReduceMax", &x, &[], &[Is("axes", &[-1])]), &[2, 1], &[2.0, 5.0]);
}

#[test]
fn images_are_rearranged_resized_and_pooled() {
    let ints = |values: &[i64]| Tensor::integers(vec![values.len()], values.to_vec());
    let depth = Tensor::floats(vec![1, 4, 1, 2], (0..8).map(|v| v as f32).collect());
    expect(
        &node("DepthToSpace", &depth, &[], &[I("blocksize", 2)]),
        &[1, 1, 2, 4],
        &[0.0, 2.0, 1.0, 3.0, 4.0, 6.0, 5.0, 7.0],
    );
    let image = Tensor::floats(vec![1, 1, 2, 2], vec![0.0, 1.0, 2.0, 3.0]);
    let none = Tensor::floats(vec![0], vec![]);
    let sizes = ints(&[1, 1, 3, 3]);
    expect(
        &node(
            "Resize",
            &image,
            &[("r", &none), ("s", &none), ("t", &sizes)],
            &[S("mode", "linear"), S("coordinate_transformation_mode", "align_corners")],
        ),
        &[1, 1, 3, 3],
        &[0.0, 0.5, 1.0, 1.0, 1.5, 2.0, 2.0, 2.5, 3.0],
    );
    expect(
        &node("MaxPool", &image, &[], &[Is("kernel_shape", &[2, 2]), Is("pads", &[1, 1, 0, 0])]),
        &[1, 1, 2, 2],
        &[0.0, 1.0, 2.0, 3.0],
    );
    expect(&node("AveragePool", &image, &[], &[Is("kernel_shape", &[2, 2])]), &[1, 1, 1, 1], &[1.5]);
    expect(&node("GlobalAveragePool", &image, &[], &[]), &[1, 1, 1, 1], &[1.5]);
}

/// A small network: a convolution whose result is resized to the size of the input. The nodes Shape, Slice and Concat
/// compute this size. The output does not depend on the last node, Sin.
fn small() -> Writer {
    let weights = noise(5, &[4, 3, 3, 3]);
    Writer::new(13, &[1, 3, 16, 16])
        .constant("w", &weights)
        .integers("first", &[2])
        .integers("last", &[4])
        .floats("empty", &[0], &[])
        .integers("front", &[1, 4])
        .integers("axes", &[1])
        .node("Conv", &["x", "w"], "a", &[Is("strides", &[2, 2]), Is("pads", &[1, 1, 1, 1])])
        .node("Relu", &["a"], "b", &[])
        .node("Shape", &["x"], "c", &[])
        .node("Slice", &["c", "first", "last"], "d", &[])
        .node("Concat", &["front", "d"], "e", &[I("axis", 0)])
        .node("Resize", &["b", "empty", "empty", "e"], "f", &[S("mode", "linear")])
        .node("ReduceMean", &["f"], "g", &[Is("axes", &[1])])
        .node("Squeeze", &["g", "axes"], "y", &[])
        .node("Sin", &["x"], "unused", &[])
}

#[test]
fn a_network_runs_as_written_whatever_the_number_of_threads() {
    let (file, x) = (small().file(), noise(9, &[1, 3, 16, 16]));
    let network = Network::parse(&file).unwrap();
    assert_eq!(network.input_shape(), [Some(1), Some(3), Some(16), Some(16)]);
    assert_eq!(network.nodes.len(), 8, "what the output does not need is not run");
    let with = |threads: usize| {
        let got = Pool::new(threads).unwrap().run(|| run(&file, &x)).unwrap();
        (got.shape.clone(), got.as_floats().unwrap().to_vec())
    };
    assert_eq!(with(1).0, [1, 16, 16]);
    assert!(with(1) == with(3));
    let monitor = Monitor::default();
    monitor.cancel();
    assert_eq!(network.run(x, monitor.job()).unwrap_err(), Error::cancelled());
}

#[test]
fn damaged_files_are_errors() {
    let (file, x) = (small().file(), noise(9, &[1, 3, 16, 16]));
    for length in 0..file.len() {
        if let Ok(network) = Network::parse(&file[..length]) {
            let _ = network.run(x.clone(), Monitor::default().job());
        }
    }
    assert_eq!(Network::parse(&file[..file.len() / 2]).err().unwrap().kind, ErrorKind::Format);
    let mut rng = Rng::new(3, &[]);
    for _ in 0..4000 {
        let mut damaged = file.clone();
        for _ in 0..=rng.next_u32() % 4 {
            let at = rng.next_u32() as usize % damaged.len();
            damaged[at] = rng.next_u32() as u8;
        }
        if let Ok(network) = Network::parse(&damaged) {
            let _ = network.run(x.clone(), Monitor::default().job());
        }
    }
}

#[test]
fn remainders_of_integers_have_the_sign_that_fmod_selects() {
    let (a, b) = ([-4, 7, 5, 4, -7, 8, i64::MAX - 1], [2, -3, 8, -2, 3, 5, i64::MAX]);
    let integers = |values: &[i64]| Tensor::integers(vec![values.len()], values.to_vec());
    let remainders = |settings: &[super::writer::Setting]| {
        let writer = Writer::new(17, &[1]).constant("a", &integers(&a)).constant("b", &integers(&b));
        let file = writer.node("Mod", &["a", "b"], "y", settings).file();
        run(&file, &Tensor::floats(vec![1], vec![0.0])).unwrap().as_integers().unwrap().to_vec()
    };
    assert_eq!(remainders(&[]), [0, -2, 5, 0, 2, 3, i64::MAX - 1]);
    assert_eq!(remainders(&[I("fmod", 0)]), remainders(&[]));
    assert_eq!(remainders(&[I("fmod", 1)]), [0, 1, 5, 0, -1, 3, i64::MAX - 1]);
    // Remainders of floats have the sign of the dividend.
    let x = Tensor::floats(vec![2], vec![-4.3, 7.5]);
    let y = Tensor::floats(vec![2], vec![2.0, -3.0]);
    close(&node("Mod", &x, &[("b", &y)], &[I("fmod", 1)]), &[2], |i| [-0.3, 1.5][i]);
}

#[test]
fn sum_min_and_max_take_any_number_of_inputs() {
    let (x, y, z) = (noise(1, &[2, 3]), noise(2, &[3]), noise(3, &[2, 1]));
    for kind in ["Sum", "Min", "Max"] {
        assert_eq!(node(kind, &x, &[], &[]).as_floats().unwrap(), x.as_floats().unwrap());
    }
    let [a, b, c] = [&x, &y, &z].map(|t| t.as_floats().unwrap());
    close(&node("Sum", &x, &[("b", &y), ("c", &z)], &[]), &[2, 3], |i| f64::from(a[i] + b[i % 3] + c[i / 3]));
    // An operator with exactly two inputs, such as Add, refuses a single input.
    let file = Writer::new(17, &[2, 3]).node("Add", &["x"], "y", &[]).file();
    assert_eq!(run(&file, &x).unwrap_err().kind, ErrorKind::Format);
}

#[test]
fn files_that_ask_for_more_than_there_is_are_refused() {
    let x = Tensor::floats(vec![1, 4], vec![0.5; 4]);
    let huge = Tensor::integers(vec![2], vec![1 << 20, 1 << 20]);
    let one = Tensor::integers(vec![1], vec![1]);
    let with = |build: &dyn Fn(Writer) -> Writer| {
        let start = Writer::new(13, &[1, 4]).constant("huge", &huge).integers("many", &[1 << 40]);
        let error = run(&build(start).file(), &x).unwrap_err();
        assert!(matches!(error.kind, ErrorKind::OutOfMemory | ErrorKind::Format | ErrorKind::Unsupported), "{error}");
        error
    };
    let made = with(&|w| w.node("ConstantOfShape", &["huge"], "y", &[T("value", one.clone())]));
    assert_eq!(made.kind, ErrorKind::OutOfMemory);
    with(&|w| w.node("ConstantOfShape", &["many"], "y", &[]));
    with(&|w| w.integers("s", &[1 << 40, 4]).node("Expand", &["x", "s"], "y", &[]));
    with(&|w| w.integers("s", &[0, 1 << 40]).node("Expand", &["x", "s"], "y", &[]));
    with(&|w| w.integers("s", &[1 << 40, 1]).node("Tile", &["x", "s"], "y", &[]));
    with(&|w| w.integers("s", &[1 << 62, 0, 0, 0]).node("Pad", &["x", "s"], "y", &[]));
    with(&|w| w.integers("s", &[1 << 40, 0, 0, 0]).node("Pad", &["x", "s"], "y", &[]));
    with(&|w| {
        let (w, t) = (w.constant("a", &Tensor::integers(vec![], vec![0])), Tensor::integers(vec![], vec![i64::MAX]));
        w.constant("b", &t).constant("c", &Tensor::integers(vec![], vec![1])).node("Range", &["a", "b", "c"], "y", &[])
    });
    // Each of these gives an error: a missing weight, a product of 2^15 × 2^15 numbers (4 GiB), and a size that doubles
    // with each node.
    with(&|w| w.node("Add", &["x", "nothing"], "y", &[]));
    with(&|w| {
        let column = Tensor::floats(vec![1 << 15, 1], vec![1.0; 1 << 15]);
        let row = Tensor::floats(vec![1, 1 << 15], vec![1.0; 1 << 15]);
        w.constant("c", &column).constant("r", &row).node("MatMul", &["c", "r"], "y", &[])
    });
    with(&|mut w| {
        for k in 0..40 {
            let from = if k == 0 { "x".to_string() } else { format!("v{k}") };
            let to = if k == 39 { "y".to_string() } else { format!("v{}", k + 1) };
            w = w.node("Concat", &[&from, &from], &to, &[I("axis", 1)]);
        }
        w
    });
    // The error names an unsupported operator.
    let error = with(&|w| w.node("Loop", &["x"], "y", &[]));
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains("Loop"), "{error}");
    let error = with(&|w| w.node("Conv", &["x", "x"], "y", &[Is("strides", &[0, 0])]));
    assert!(error.message.contains("strides"), "{error}");
    assert_eq!(Network::parse(b"").err().unwrap().kind, ErrorKind::Format);
    assert_eq!(Network::parse(&Writer::new(99, &[1]).file()).err().unwrap().kind, ErrorKind::Unsupported);
}
