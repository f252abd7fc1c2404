#!/bin/sh
# A Slurm cluster on one machine: one controller and two daemons on loopback. A small campaign runs
# as a job array, one of the two nodes dies in its middle, and the table must still be that of a
# local run, byte for byte.
#
#   benches/slurm/loopback.sh TUMBLE PLAN.toml [FOLDER]
#
# TUMBLE is the program, PLAN.toml a plan. Needs root and Debian's packages slurm-wlm and munge
# (apt-get install slurm-wlm munge), whose slurmd is built for several daemons on one host.
set -eu

tumble=$(realpath "${1:?usage: loopback.sh TUMBLE PLAN.toml [FOLDER]}")
PATH="$(dirname "$tumble"):$PATH"
plan=$(realpath "${2:?usage: loopback.sh TUMBLE PLAN.toml [FOLDER]}")
folder=${3:-$(mktemp -d)}
mkdir -p "$folder"
folder=$(realpath "$folder")
[ "$(id -u)" = 0 ] || { echo "loopback.sh: daemons need root" >&2; exit 1; }
for program in munged slurmctld slurmd sbatch squeue scontrol; do
    command -v "$program" >/dev/null || {
        echo "loopback.sh: no $program; apt-get install slurm-wlm munge" >&2
        exit 1
    }
done

host=$(hostname -s)
export SLURM_CONF="$folder/slurm.conf"
mkdir -p "$folder/state" "$folder/node1" "$folder/node2"
cat >"$SLURM_CONF" <<CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
AuthType=auth/munge
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
SlurmdTimeout=5
SlurmctldTimeout=10
KillWait=5
JobRequeue=1
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$folder/state
SlurmctldPidFile=$folder/slurmctld.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdSpoolDir=$folder/%n
SlurmdPidFile=$folder/%n.pid
SlurmdLogFile=$folder/%n.log
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=16818 CPUs=1 State=UNKNOWN
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=16819 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF

down() {
    for name in node1 node2 slurmctld; do
        [ -f "$folder/$name.pid" ] && kill "$(cat "$folder/$name.pid")" 2>/dev/null || true
    done
}
trap down EXIT INT TERM

[ -s /etc/munge/munge.key ] || create-munge-key -f >/dev/null 2>&1 || mungekey --create
mkdir -p /run/munge && chown munge:munge /run/munge
munge -n >/dev/null 2>&1 || runuser -u munge -- munged
# Both nodes are this host: it may hold as many processors as they claim.
slurmctld -c
slurmd -N node1
slurmd -N node2
tries=0
until [ "$(sinfo -h -N -t idle -o %N | wc -l)" -eq 2 ]; do
    tries=$((tries + 1))
    [ "$tries" -le 60 ] || { echo "loopback.sh: nodes do not come up:" >&2; sinfo >&2; exit 1; }
    sleep 1
done
echo "two nodes are up"

"$tumble" run "$plan" --out "$folder/array" --slurm
cd "$folder"
job=$(sbatch --parsable "$folder/array/campaign.slurm")
echo "job array $job"
# Wait until node2 works, then let it die with all that runs on it.
tries=0
until squeue -h -w node2 -t R -o %A | grep -q .; do
    tries=$((tries + 1))
    [ "$tries" -le 60 ] || { echo "loopback.sh: node2 gets no work" >&2; exit 1; }
    sleep 0.5
done
sleep 2
task=$(squeue -h -w node2 -t R -o %A | head -n 1)
row=$(squeue -h -w node2 -t R -o %K | head -n 1)
kill -9 "$(cat "$folder/node2.pid")"
pkill -9 -f "slurmstepd: \[$task" || true
pkill -9 -f "$folder/array .*--index $row\$" || true
echo "node2 died while it worked on run $row"
while squeue -h -j "$job" 2>/dev/null | grep -q .; do
    sleep 1
done
sinfo -N -o "%N %t"
"$tumble" run "$plan" --out "$folder/array" --collect
"$tumble" run "$plan" --out "$folder/local" --jobs 2 >/dev/null
cmp "$folder/array/responses.csv" "$folder/local/responses.csv"
echo "the table of the array is that of the local run, byte for byte: $(grep -vc '^#' "$folder/array/responses.csv") lines"
