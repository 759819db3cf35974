#compdef mav
# Completion of mav in zsh. For all sessions, with ~/.zfunc in fpath before compinit:
#   mav completion zsh > ~/.zfunc/_mav
# or, after compinit in ~/.zshrc:
#   eval "$(mav completion zsh)"

_mav() {{
    local at=mav option="${{words[CURRENT-1]}}" files=
    local -a items choices
    integer i
    for ((i = 2; i < CURRENT; i++)); do
        case "$at ${{words[i]}}" in
            ({paths}) at="$at ${{words[i]}}" ;;
        esac
    done
    if [[ ${{words[CURRENT]}} == --*=* ]]; then
        option="${{words[CURRENT]%%=*}}"
        compset -P '*='
    fi
    case "$at $option" in
{values}
    esac
    if [[ ${{words[CURRENT]}} == -* ]]; then
        case "$at" in
{options}
        esac
        _describe -o 'option' items
        return
    fi
    case "$at" in
{words}
    esac
    (( ${{#items}} )) && _describe 'command' items
    [[ -n $files ]] && _files
}}

if [[ ${{funcstack[1]}} == _mav ]]; then
    _mav "$@"
else
    compdef _mav mav
fi
