# Completion of mav in bash. For all sessions:
#   mav completion bash > ~/.local/share/bash-completion/completions/mav
# or, without bash-completion, in ~/.bashrc:
#   eval "$(mav completion bash)"

_mav() {{
    local current="${{COMP_WORDS[COMP_CWORD]}}" option="${{COMP_WORDS[COMP_CWORD-1]}}"
    local path=mav words= files= i IFS=$' \t\n'
    if [[ $current == "=" ]]; then  # bash splits --option=value into three words
        current=
    elif [[ $option == "=" ]]; then
        option="${{COMP_WORDS[COMP_CWORD-2]}}"
    fi
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$path ${{COMP_WORDS[i]}}" in
            {paths}) path="$path ${{COMP_WORDS[i]}}" ;;
        esac
    done
    case "$path $option" in
{values}
        *)
            if [[ $current == -* ]]; then
                case "$path" in
{options}
                esac
            else
                case "$path" in
{words}
                esac
            fi ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    if [[ $files ]]; then
        IFS=$'\n'
        COMPREPLY+=($(compgen -f -- "$current"))
        compopt -o filenames 2>/dev/null
    fi
}}
complete -F _mav mav
