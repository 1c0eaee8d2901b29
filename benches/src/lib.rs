//! Host benches: the device's engines with criterion (`benches/`), training jobs beside what is used today
//! (`src/bin/host-jobs`, `peers/host.py`).
