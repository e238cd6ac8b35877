//! Inputs once more without libFuzzer: those of the folder LUXFER_FUZZ_INPUTS, one folder in it for each target. For Miri
//! (tests/miri.sh), and for what has been found.

#[test]
fn inputs_give_statuses() {
    let Ok(folder) = std::env::var("LUXFER_FUZZ_INPUTS") else { return };
    for (target, run) in luxfer_fuzz::TARGETS {
        let Ok(files) = std::fs::read_dir(format!("{folder}/{target}")) else { continue };
        let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            println!("{}", path.display());
            run(&std::fs::read(path).unwrap());
        }
    }
}
