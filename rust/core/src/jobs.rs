//! Work that several threads share: each takes the next job when it has finished one, so that a thread that the system
//! delays delays the others by one job at most.

use std::sync::Mutex;
use std::thread;

/// Runs `work` for each job on up to `threads` threads, this one included: a single job starts no thread.
pub fn run<Job: Send>(jobs: Vec<Job>, threads: usize, work: impl Fn(Job) + Sync) {
    let threads = threads.min(jobs.len());
    let jobs = Mutex::new(jobs.into_iter());
    let next = || jobs.lock().ok()?.next();
    let take_jobs = || {
        while let Some(job) = next() {
            work(job);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(take_jobs);
        }
        take_jobs();
    });
}

/// Returns the result of `work` for each job, in the order of the jobs; see [`run`].
pub fn collect<Job: Send, Output: Send>(
    jobs: Vec<Job>,
    threads: usize,
    work: impl Fn(Job) -> Output + Sync,
) -> Vec<Output> {
    let mut results: Vec<Option<Output>> = jobs.iter().map(|_| None).collect();
    run(jobs.into_iter().zip(&mut results).collect(), threads, |(job, result)| *result = Some(work(job)));
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_job_runs_once() {
        for threads in [0, 1, 3, 100] {
            let mut rows = [0; 50];
            run(rows.iter_mut().collect(), threads, |row| *row += 1);
            assert_eq!(rows, [1; 50]);
        }
    }

    #[test]
    fn results_have_the_order_of_the_jobs() {
        for threads in [0, 1, 3] {
            let squares: Vec<u32> = collect((0..50).collect(), threads, |number| number * number);
            assert!(squares.into_iter().eq((0..50).map(|number| number * number)));
        }
    }

    #[test]
    fn a_single_job_runs_on_the_calling_thread() {
        let caller = thread::current().id();
        assert_eq!(collect(vec![()], 8, |()| thread::current().id()), [caller]);
    }
}
