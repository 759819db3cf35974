//! The beginning of every row, and the threads that fill rows.
//!
//! A row begins with its time and the instance of its sensor; the fields of the record follow.

use std::sync::Mutex;
use std::thread;

/// Bytes of a row before the fields: time in microseconds (8), instance, three zero bytes.
pub const ROW_HEADER: usize = 12;
/// Position of the instance in a row.
pub const INSTANCE: usize = 8;
/// Time of a row without a known time: numpy's `NaT`.
pub const NO_TIME: i64 = i64::MIN;

/// Runs `work` for each job on up to `threads` threads, this one included.
pub fn run_jobs<Job: Send>(jobs: Vec<Job>, threads: usize, work: impl Fn(Job) + Sync) {
    let threads = threads.min(jobs.len());
    let jobs = Mutex::new(jobs.into_iter());
    let next = || jobs.lock().ok()?.next();
    let run = || {
        while let Some(job) = next() {
            work(job);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(run);
        }
        run();
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_job_runs_once() {
        for threads in [0, 1, 3, 100] {
            let mut rows = [0; 50];
            run_jobs(rows.iter_mut().collect(), threads, |row| *row += 1);
            assert_eq!(rows, [1; 50]);
        }
    }
}
